#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/coefficients/outgoing.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline material_maps {

/// The coefficients that a texel of a material map has, and their order. A *shape* is the
/// coefficients of one channel, [outgoing][slot]; a texel in float32 is [outgoing][lane] with lane
/// = channel * slots + slot, padded by zeros to groups of four: an RGBA layer of a texture array
/// each.
struct TexelLayout {
    OutgoingSet outgoing = {};
    std::vector<int> slots = {};  ///< the functions kept: l (l + 1) + m
    std::size_t channels = 3;

    std::size_t shape() const { return outgoing.size() * slots.size(); }
    std::size_t groups() const { return (channels * slots.size() + 3) / 4; }
    std::size_t stride() const { return 4 * groups(); }  ///< floats of one outgoing direction
    std::size_t layers() const { return outgoing.size() * groups(); }
    std::size_t floats() const { return outgoing.size() * stride(); }  ///< of a texel

    /// The weights, one for each outgoing direction, with which squares of coefficients sum up to
    /// the energy in the inner product of the basis (Parseval): the solid angles.
    const std::vector<double>& weights() const { return outgoing.solidAngles; }
};

/// The functions that the basis has; of a mirror-symmetric BRDF for outgoing directions in the xz
/// plane (elevations) those with m >= 0 alone, since the others have coefficients of zero.
TexelLayout texelLayout(const Basis& basis, const OutgoingSet& outgoing, std::size_t channels,
                        bool mirrorSymmetric);

}  // namespace hshfit::inline material_maps
