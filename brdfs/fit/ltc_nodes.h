#pragma once

#include <brdfs/fit/ltc.h>
#include <hshfit/brdf.h>

#include <vector>

namespace hshfit::brdfs {

/// How densely the sphere of the cosine is covered: panels in its height z, Gauss-Legendre rings in
/// each, and azimuths of the half sphere y > 0.
struct LtcRule {
    std::vector<double> breaks;  ///< ends of the panels, from 0 to 1; the same below
    int rings = 8;
    int azimuths = 16;
};
/// For the iterations, for the results, and another one to compare these with.
const LtcRule& coarseRule();
const LtcRule& fineRule();
const LtcRule& otherRule();

/// f cos(theta_i) at nodes over the whole sphere of wi that are spread as `around` spreads a
/// cosine: even there where it has its weight, and ever sparser beyond. f is mirrored at y = 0.
struct LtcNodes {
    std::vector<Direction> cosines;  ///< of the sphere of the cosine
    std::vector<Direction> wi;       ///< where `around` takes them
    std::vector<double> weights;     ///< d omega of wi, both halves counted
    std::vector<double> stretches;   ///< d omega of wi over that of the cosine
    std::vector<double> values;      ///< f cos(theta_i)

    /// Throws NumericError where f is not finite.
    LtcNodes(const Brdf& brdf, const Direction& wo, const Ltc& around, const LtcRule& rule);
};

}  // namespace hshfit::brdfs
