#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/halfway/internal/halfway_fit.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// Directional albedo averaged over strata of cos(theta_o), by the pairs of pair_sample.h, and what
/// it is for f. Where `reciprocal`, of the mean of f and f with wi and wo exchanged.
struct HalfwayAlbedo {
    std::vector<DirectionPair> pairs;
    std::vector<double> weights;     ///< albedo of a stratum: the sum of weight f over its pairs
    std::vector<std::size_t> first;  ///< [stratum], and the number of pairs
    std::vector<double> shares;      ///< [stratum] of cos(theta_o); they add up to 1
    std::vector<double> targets;     ///< [stratum][channel]

    std::size_t strata() const { return shares.size(); }
    std::size_t channels() const { return targets.size() / shares.size(); }
    /// The mean over strata, of the channel that has most.
    double greatestMean() const;
};
HalfwayAlbedo albedoOf(const Brdf& brdf, bool reciprocal);

/// Adds the squares of the relative errors of the albedos to the systems, the loss alone to those
/// without a matrix: the mean over strata to 85 degrees weighs ten times as much as a square of a
/// logarithm.
void addAlbedo(const HalfwayModel& model, const HalfwayAlbedo& albedo, const HalfwayValues& values,
               std::vector<HalfwaySystem>& systems);

}  // namespace hshfit::inline representation::inline halfway
