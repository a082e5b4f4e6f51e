#pragma once

#include <brdfs/fit/ltc.h>
#include <hshfit/brdf/brdf.h>

#include <vector>

namespace hshfit::brdfs {

/// The nodes on the sphere of the cosine, in longitudes about y and latitudes from the plane of
/// incidence: Gauss-Legendre nodes in panels between these fractions. The planes where the
/// cosine and where cos(theta_i) become 0 meet in the y axis; so both lie between panels.
struct LtcRule {
    std::vector<double> longitudes;  ///< of each of the up to three sectors between the planes
    std::vector<double> latitudes;   ///< of a quarter turn
    int nodes = 4;                   ///< in a panel, either way
};
/// For the iterations, and for the results.
const LtcRule& coarseRule();
const LtcRule& fineRule();

/// f cos(theta_i) at nodes over all wi where it or the density of `around` is not 0. Nodes are
/// spread as `around` spreads a cosine: even there where it has its weight, and ever sparser
/// beyond. f is mirrored at y = 0.
struct LtcNodes {
    std::vector<Direction> cosines;  ///< of the sphere of the cosine
    std::vector<Direction> wi;       ///< where `around` takes them
    std::vector<double> weights;     ///< d omega of wi, both halves counted
    std::vector<double> stretches;   ///< d omega of wi / d omega on the sphere of the cosine
    std::vector<double> values;      ///< f cos(theta_i)

    /// Throws NumericError where f is not finite.
    LtcNodes(const Brdf& brdf, const Direction& wo, const Ltc& around, const LtcRule& rule);

    double integral() const;  ///< of f cos(theta_i)
};

/// `rule` with half as many nodes again and again, until the integral of f cos(theta_i) changes by
/// no more than `tolerance` of it or a panel has `mostNodes`.
LtcRule settledRule(const Brdf& brdf, const Direction& wo, const Ltc& around, LtcRule rule,
                    double tolerance, int mostNodes);

}  // namespace hshfit::brdfs
