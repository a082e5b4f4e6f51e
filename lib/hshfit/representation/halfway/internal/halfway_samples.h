#pragma once

#include <hshfit/brdf/brdf.h>

#include <array>
#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The way in which a pair was drawn:
///     uniform  both directions uniform on their hemispheres
///     mirror   wo uniform, wi about its mirror direction, sin(theta_h) by powers of ten from 1e-4
///     line     theta_d fixed, h moving in the plane of incidence or across it; or wi fixed, wo
///              moving in the plane of incidence
///     ridge    wi the mirror direction of wo
///     grazing  cosines by powers of ten from 1e-3, wi likewise or about the mirror direction
///     normal   wi or wo the normal
///     seen     a pixel of a sphere under a lamp 5, 20, 35, 50, 65 or 80 degrees from the line of
///              sight
enum class HalfwaySpread : unsigned char { uniform, mirror, line, ridge, grazing, normal, seen };
inline constexpr std::size_t halfwaySpreads = 7;

/// Pairs of directions with f at each.
struct HalfwaySamples {
    std::vector<DirectionPair> pairs;
    std::vector<HalfwaySpread> spread;
    std::vector<double> values;  ///< f, [sample][channel]; negative values are 0

    std::size_t size() const { return pairs.size(); }
    std::size_t channels() const { return pairs.empty() ? 0 : values.size() / size(); }
};

/// Three disjoint sequences of pairs: pairs that are fitted, pairs of all spreads that take no
/// part, and uniform pairs that take no part.
enum class HalfwayPart { fitted, heldOut, heldOutUniform };

/// Appends pairs number `first` .. `last` - 1 of the sequence of a part, leaving out pairs below
/// the horizon. The sequence is Roberts' R_d, frac(1/2 + n / phi_d^j) with phi_d^{d+1} = phi_d + 1
/// (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018), d = 3 for an
/// isotropic BRDF and 4 otherwise. Throws NumericError where f is not finite.
void appendSamples(const Brdf& brdf, HalfwayPart part, std::size_t first, std::size_t last,
                   HalfwaySamples& samples);

}  // namespace hshfit::inline representation::inline halfway
