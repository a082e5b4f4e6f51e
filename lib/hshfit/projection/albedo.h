#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline projection {

struct AlbedoOptions {
    double tolerance = 1e-4;  ///< relative to the largest channel
    /// A change that is always small enough, for callers who only ask whether an albedo is near 1.
    double absolute = 0;
    std::size_t maxEvaluations = std::size_t{1} << 26;
};

struct AlbedoEstimate {
    std::vector<double> values;  ///< one per channel; empty if not even one level could be afforded
    double error = 0;            ///< the last change of the largest, absolute
    bool converged = false;
    std::size_t evaluations = 0;
};

/// Directional albedo, one value per channel: the integral of f(wi, wo) cos(theta_i) d omega_i, the
/// radiance towards wo under a radiance of 1 from everywhere (hemispherical-directional
/// reflectance). Nodes lie between the kinks and kink curves of f; a table with cells on the square
/// (HasSteps) is summed over at least one node a cell. Refined until levels agree to the tolerance,
/// twice in a row or well within it, or until the evaluations are spent. Throws NumericError where
/// f is not finite.
AlbedoEstimate estimateAlbedo(const Brdf& brdf, const Direction& wo, const AlbedoOptions& options);

/// Directional-hemispherical reflectance: the integral of f(wi, wo) cos(theta_o) d omega_o, the
/// share of the light from wi that is reflected. It is this number that conservation of energy
/// holds at 1; for reciprocal f it equals the albedo at wo = wi, and is computed as that.
AlbedoEstimate estimateReflectance(const Brdf& brdf, const Direction& wi,
                                   const AlbedoOptions& options);

/// The values of these. Throw NumericError where they did not converge within 2^26 evaluations,
/// too.
std::vector<double> directionalAlbedo(const Brdf& brdf, const Direction& wo,
                                      double tolerance = 1e-4);
std::vector<double> directionalReflectance(const Brdf& brdf, const Direction& wi,
                                           double tolerance = 1e-4);

}  // namespace hshfit::inline projection
