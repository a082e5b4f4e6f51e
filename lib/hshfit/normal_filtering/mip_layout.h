#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/normal_filtering/lobe_table.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::inline normal_filtering {

/// Number of coefficients of bands 0, 2, …, order - 1: order (order + 1) / 2 for odd orders.
constexpr std::size_t evenSlots(int order) {
    return static_cast<std::size_t>(order) * (order + 1) / 2;
}
/// Slot of (l, m) for even l: l (l + 1) / 2 + m.
constexpr int evenSlotOf(int l, int m) {
    return l * (l + 1) / 2 + m;
}

/// A texel of the base level, in the frame of the surface: +z its normal, +x its tangent.
struct SurfaceTexel {
    static constexpr int most = 6;
    Direction normal = {};          ///< any length but 0
    Direction tangent = {1, 0, 0};  ///< used by anisotropic tables; not along the normal
    LobePlace lobe = {0, 0};        ///< of D in the LobeTable
    std::array<double, most> weights = {1, 1, 1, 1, 1, 1};  ///< factors of D: colours, or 1
    std::array<double, most> albedos = {};                  ///< of the diffuse part, by channel
};

/// The numbers of a filtered texel: averages over its footprint, linear in texels, in this order.
///     normal 3, of length at most 1
///     plane 2, planeSquares 3 (xx, xy, yy): first and second moments of u = 2 (n.x, n.y)/(1 +
///     n.z),
///         the stereographic plane
///     widths 3 (xx, xy, yy): widthX^2 e e^T + widthY^2 e' e'^T, e the tangent in that plane
///     lobe 2, weights, albedo 9 each: albedo times Y_(l,m)(n), slots l (l + 1) + m of 3 bands
///     harmonics of weight times D(R^-1 h), one set for each weight, in slots evenSlotOf(l, m)
/// Spherical harmonics are real, orthonormal and without Condon-Shortley phase.
struct MipLayout {
    int weights = 3, albedos = 3, order = 13;

    static constexpr std::size_t normal = 0, plane = 3, planeSquares = 5, widths = 8, lobe = 11,
                                 weight = 13;
    std::size_t albedo(int channel) const { return weight + weights + 9 * channel; }
    std::size_t harmonics(int k) const { return albedo(albedos) + k * evenSlots(order); }
    std::size_t size() const { return harmonics(weights); }
    /// Numbers that the ellipse needs, the first of a texel.
    std::size_t ellipseSize() const { return harmonics(0); }

    /// Throws UsageError unless the counts are 0 … 6 and the order is odd and at most `most`.
    void check(int most) const;
};

/// A texel as it is stored, as many numbers as `texel` has: layout.size(), or layout.ellipseSize()
/// without harmonics. In place of second moments, which would cancel in few bits, stand standard
/// deviations along x and y and their correlation; in place of `widths` their roots and
/// correlation.
std::vector<double> storedNumbers(std::span<const double> texel);
/// Moments again, in place.
void momentsOf(std::span<double> stored);

/// `storedNumbers` as binary16. Throws NumericError for a number beyond 65504.
void encodeHalf(const MipLayout& layout, std::span<const double> texel,
                std::span<std::uint16_t> out);
/// Moments again.
void decodeHalf(const MipLayout& layout, std::span<const std::uint16_t> stored,
                std::span<double> texel);

}  // namespace hshfit::inline normal_filtering
