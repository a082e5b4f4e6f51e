#pragma once

#include <hshfit/light/light_nodes.h>
#include <hshfit/light/lights.h>

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline light {

struct LightTermsOptions {
    /// Levels are added until the energy of the best terms changes by less, relatively.
    double tolerance = 1e-3;
    int firstLevel = 5, lastLevel = 8;  ///< of the subdivision (wavelets/partition.h)
};

/// The energy that the best k SOHO wavelets (wavelets/soho.h) of a light capture, k = 0 .. most,
/// over the sphere or a hemisphere in its frame, chosen for R, G and B by themselves and summed.
/// Discs, panels and pictures by the flux of their parts in each leaf, which loses no flux; skies
/// and coefficients by their radiance in the middle of each leaf.
struct LightTerms {
    std::vector<double> captured;
    double error = 0;  ///< relative: a third of the last change
    int levels = 0;
};
/// Runs on all threads. Throws UsageError for light from a single direction, which has no energy.
LightTerms lightTerms(std::span<const Light> lights, const LightDomain& domain, std::size_t most,
                      const LightTermsOptions& options = {});

}  // namespace hshfit::inline light
