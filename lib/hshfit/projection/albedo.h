#pragma once

#include <hshfit/brdf/brdf.h>

#include <vector>

namespace hshfit::inline projection {

/// Directional albedo, one value per channel: the integral of f(wi, wo) cos(theta_i) d omega_i.
/// Refined until levels agree to `tolerance`, twice in a row or well within it (absolute, of a
/// quantity that is at most 1 for a passive surface). Throws NumericError where it does not
/// converge within 2^26 evaluations or f is not finite.
std::vector<double> directionalAlbedo(const Brdf& brdf, const Direction& wo,
                                      double tolerance = 1e-4);

}  // namespace hshfit::inline projection
