#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>

namespace hshfit::inline accuracy {

/// The pair of directions at which f changes most when they are exchanged, with one of the two
/// beyond 55 degrees, where measured files are least reciprocal.
struct ExchangeAtHorizon {
    Direction wi, wo;
    std::size_t channel = 0;
    double value = 0, exchanged = 0;  ///< f(wi, wo), f(wo, wi); the first is the larger
    /// The larger over the smaller, 1 if f is reciprocal there; infinite where one is 0.
    double ratio() const;
};

/// Searches elevations of 60 to 85 degrees beside 0 to 75 degrees and eight differences of
/// azimuth, for an anisotropic BRDF from four azimuths. Pairs count whose larger value of
/// f cos(theta_i) cos(theta_o) is at least a hundredth of the largest, so that it can be seen;
/// values that are not finite or negative do not count.
ExchangeAtHorizon exchangeAtHorizon(const Brdf& brdf);

}  // namespace hshfit::inline accuracy
