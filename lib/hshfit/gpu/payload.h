#pragma once

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/gpu/texels.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::gpu {

/// The arrangement of coefficients in texels.
enum class Packing {
    coef4,  ///< four consecutive coefficients of one channel; layer = firstLayer + j / 4, lane j %
            ///< 4
    rgb,    ///< one coefficient of up to four channels; layer = j, lane = channel
};
std::string packingName(Packing packing);  ///< "coef4-planar", "rgb", as in files

struct PackOptions {
    Number number = Number::float16;
    Packing packing = Packing::coef4;
    /// Store Y, Co, Cg (Malvar & Sullivan 2003) instead of R, G, B; RGB coefficients only.
    bool luminanceChroma = false;
    /// Bands kept of Co and Cg; 0: all.
    int chromaOrder = 0;
    /// Side of the basis textures (paper mode); 0: the basis is evaluated in the shader.
    int basisSize = 0;
};

/// A stored channel: the first `slots` of `Payload::slots`, from layer `firstLayer` on.
struct StoredChannel {
    std::string name;
    std::size_t slots = 0;
    std::size_t firstLayer = 0;
};

/// Coefficients as a GPU reads them, and the facts that a shader needs: the content of a container.
///
/// A shader looks the texel up for wo (bilinear, LOD 0), sums stored coefficients times basis
/// functions of wi over j, and multiplies the channels with `toChannels`:
///     q_i(wo, wi) = sum_c toChannels[i][c] sum_j C_{c,j}(wo) B_{slots[j]}(wi)
/// For `elevations` wo and wi are first turned about z until wo has azimuth 0.
///     parabolic   p = (x, y)/(1 + z) of wo;  uv = 1/2 + p (N - 2)/(2 N) per axis
///     elevations  r = |p|;  u = (r (N - 1/2) + 1/2)/N, v = 1/2
///     direction   one texel
struct Payload {
    CoefficientHead head;

    Packing packing = Packing::coef4;
    /// Stored slots l(l+1)+m, ascending. They leave out functions that the basis lacks, and
    /// sin(m phi) for an isotropic, mirror symmetric BRDF on the map `elevations`.
    std::vector<int> slots;
    std::vector<StoredChannel> stored;
    std::vector<std::vector<double>> toChannels;  ///< [channel][stored channel]
    Texels coefficients;
    /// The stored basis functions over the parabolic map of wi, packed coef4.
    std::optional<Texels> basisTexels;

    /// Layer and lane of stored coefficient `j` of stored channel `c`.
    std::array<std::size_t, 2> place(std::size_t c, std::size_t j) const {
        if (packing == Packing::rgb) return {j, c};
        return {stored[c].firstLayer + j / 4, j % 4};
    }
    /// Whether the corner texels of layer 0 hold 1, 2, 3, 4 (lane 0; row by row) to tell flips
    /// apart. No lookup reads them: parabolic maps from 8x8 on. unorm payloads have none.
    bool marked() const;
};

/// The number of layers that every API supports: the minimum of WebGPU and WebGL2.
constexpr std::size_t maxLayers = 256;

/// Packs coefficients. Throws UsageError for more than `maxLayers` layers, luminance and chroma of
/// anything but RGB, `rgb` packing of more than four channels; NumericError for a coefficient that
/// is not finite or beyond the range of the number type.
Payload pack(const Coefficients& coefficients, const PackOptions& options);

/// The coefficients as a GPU reads them (after rounding), in all slots and in the original
/// channels. Marked corner texels take the value of the texel diagonally inside.
Coefficients unpack(const Payload& payload);

}  // namespace hshfit::gpu
