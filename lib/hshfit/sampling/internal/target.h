#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/sampling/sampler.h>

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline sampling {

/// The function that a density has to follow for one outgoing direction: |f| cos(theta_i), the mean
/// over channels, at the nodes of the mean of two quadratures: one by the lobes that f names, and
/// one with cells of every scale about the mirror direction. Values that are not finite count as 0.
struct Target {
    Direction wo;
    std::vector<Direction> wi;
    std::vector<double> solidAngle, value;
    double total = 0;  ///< integral of `value`
};
Target targetAt(const Brdf& brdf, const Direction& wo);
/// Targets at the outgoing direction with this cosine and sine of its polar angle: at one azimuth
/// if f is isotropic, else at three.
std::vector<Target> targetsAtHeight(const Brdf& brdf, double cosine, double sine);
/// The same at the middle of a bin of elevation_bins.h.
std::vector<Target> targetsOfBin(const Brdf& brdf, std::size_t bin, std::size_t bins);

/// The mean over channels of |f|, 0 where it is not finite; f as `Brdf::eval` lays it out.
double meanMagnitude(std::span<const double> f, std::size_t k, std::size_t count,
                     std::size_t channels);

/// Densities of one part at all nodes of some targets, one after the other.
using NodeDensities = std::vector<double>;
NodeDensities densitiesAt(const Sampler& sampler, std::span<const Target> targets);

/// The shares that minimise the second moment, the sum over targets of
///     integral of value^2 / (sum_k share_k pdf_k) / total^2,
/// with a least share for part 0, whose density is above 0 at every node. Each step multiplies
/// every share by the root of the derivative and never raises the moment (majorisation of the
/// convex 1 / p). Equal shares to begin with.
struct LeastMoment {
    std::vector<double> shares;
    double moment = 0;  ///< the mean over targets; at least 1
};
LeastMoment leastSecondMoment(std::span<const Target> targets,
                              std::span<const NodeDensities* const> parts, double leastFirst,
                              int steps);

}  // namespace hshfit::inline sampling
