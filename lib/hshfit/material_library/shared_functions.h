#pragma once

#include <hshfit/material_library/library.h>
#include <hshfit/representation/representation.h>

#include <vector>

namespace hshfit::material_library {

/// The functions that the materials of a basis share, as sums of functions of the halfway form:
/// channel 0 is the mean, channel k the step times component k - 1, each the smooth part and the
/// lobe's together, so that
///     ln(f + logOffset) = min(Phi_0 + sum_k q_k Phi_k, ln(logOffset) + t / topsPerLog),
/// q_k being multiplied by the scale of the channel.
Representation sharedFunctions(const Basis& basis);

/// A texel of four halves, R, G, B and a 0: scale times it is a part of q_k of `function` k.
struct TexelPart {
    std::size_t function = 0;
    double scale = 1;
};
/// Numbers of a material, but for its last texel, which has t: one for each component, and two
/// where a half does not hold all digits, for components of more than 10 bits (without scales, 12).
std::vector<TexelPart> texelParts(const Basis& basis);

/// The texels of a material with codes; a grey one has its numbers three times.
std::vector<double> texelsOf(const Basis& basis, const Material& material);

}  // namespace hshfit::material_library
