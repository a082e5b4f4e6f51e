#pragma once

#include <hshfit/brdf/kink_curve.h>

#include <span>
#include <vector>

namespace hshfit::brdfs {

/// Where the masking of V-shaped grooves (half_vector.h) sets in: 2 h.z min(cos_i, cos_o) = h.wo,
/// which times |wi + wo| is 2 (cos_i + cos_o) min(cos_i, cos_o) = 1 + wi wo.
std::vector<KinkCurve> vGrooveKinks(const Direction& wo);

/// The border of max(0, axis wi)^exponent. None for exponents whose lobe has vanished before it.
std::vector<KinkCurve> clampedPowerKinks(const Direction& axis, double exponent);

/// The circle of h.wo equal to this value: the directions at twice its angle from wo.
KinkCurve halfAngleKink(const Direction& wo, double cosine, bool smoothSides);

/// The critical angle of facets with an index of refraction below 1: sin(theta) = index. F goes
/// like the root of the distance there.
std::vector<KinkCurve> totalReflectionKinks(const Direction& wo, std::span<const double> indices);

}  // namespace hshfit::brdfs
