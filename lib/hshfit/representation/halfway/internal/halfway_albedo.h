#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/halfway/halfway_envelope.h>
#include <hshfit/representation/halfway/internal/halfway_fit.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// Directional albedo averaged over strata of cos(theta_o), by the pairs of pair_sample.h, and what
/// it is for f. Where `reciprocal`, of the mean of f and f with wi and wo exchanged.
struct HalfwayAlbedo {
    std::vector<HalfwayPoint> points;
    std::vector<EnvelopePoint> places;
    std::vector<double> weights;     ///< albedo of a stratum: the sum of weight f over its points
    std::vector<std::size_t> first;  ///< [stratum], and the number of points
    std::vector<double> shares;      ///< [stratum] of cos(theta_o); they add up to 1
    std::vector<double> targets;     ///< [stratum][channel]

    std::size_t strata() const { return shares.size(); }
    std::size_t channels() const { return targets.size() / shares.size(); }
    /// The mean over strata, of the channel that has most.
    double greatestMean() const;
};
HalfwayAlbedo albedoOf(const Brdf& brdf, bool reciprocal);

/// f of the expansion at the points, [point][channel].
std::vector<double> expansionAt(const HalfwayTerms& terms, const HalfwayAlbedo& albedo,
                                const HalfwayValues& values);
/// Albedo of values f at the points, cut off at exp of `caps` ([point][channel], or empty):
/// [stratum][channel].
std::vector<double> albedoOf(const HalfwayAlbedo& albedo, const std::vector<double>& f,
                             const std::vector<double>& caps);

/// Mean over strata and channels of ((a - b) / b)^2, a the albedo of the expansion and b that of f.
/// Adds `weight` times its Gauss-Newton approximation at `values` to `systems`.
double addAlbedo(const HalfwayTerms& terms, const HalfwayAlbedo& albedo,
                 const std::vector<double>& caps, const HalfwayValues& values, double weight,
                 std::vector<HalfwaySystem>& systems);

/// Descends further from a fit until the albedos are right too: the loss plus 50 times that of the
/// fit times the mean above, so that 2 % of albedo weigh as much as 2 % of the loss.
HalfwayFit heldToAlbedo(const HalfwayTerms& terms, const HalfwaySamples& samples,
                        const HalfwayAlbedo& albedo, const std::vector<double>& caps,
                        HalfwayFit fit);

}  // namespace hshfit::inline representation::inline halfway
