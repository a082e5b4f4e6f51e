#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline projection {

struct AlbedoOptions {
    double tolerance = 1e-4;  ///< relative to the largest channel, or to 1 where that is less
    std::size_t maxEvaluations = std::size_t{1} << 26;
};

struct AlbedoEstimate {
    std::vector<double> values;  ///< one per channel; empty if not even one level could be afforded
    double error = 0;            ///< the last change of the largest, absolute
    bool converged = false;
    std::size_t evaluations = 0;
};

/// Directional albedo, one value per channel: the integral of f(wi, wo) cos(theta_i) d omega_i.
/// Refined until levels agree to the tolerance, twice in a row or well within it, or until the
/// evaluations are spent. Throws NumericError where f is not finite.
AlbedoEstimate estimateAlbedo(const Brdf& brdf, const Direction& wo, const AlbedoOptions& options);

/// The values of it. Throws NumericError where it did not converge within 2^26 evaluations, too.
std::vector<double> directionalAlbedo(const Brdf& brdf, const Direction& wo,
                                      double tolerance = 1e-4);

}  // namespace hshfit::inline projection
