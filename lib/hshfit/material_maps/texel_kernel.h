#pragma once

#include <hshfit/material_maps/lobe_grid.h>
#include <hshfit/material_maps/texel_layout.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::inline material_maps {

/// Parameters of neighbouring texels: the weights of lobes, and the place in the table of lobes.
struct TexelBlock {
    std::size_t count = 0;
    std::vector<float> weights = {};  ///< [lobe][channel][texel]
    std::vector<float> places = {};   ///< [axis][channel or 1][texel]
};

/// Coefficients of texels from a table of lobes: for each channel c
///     x_c = sum over lobes k of w_{k,c} C_k(p),   C_k interpolated in the table,
/// with vectors of the processor's widest instruction set. Immutable; safe to use from many
/// threads. Results do not depend on how texels are grouped into blocks.
class TexelKernel {
public:
    /// The table's lobes are shapes of the layout. `placesByChannel`: every channel has a place of
    /// its own. Both references have to outlive this.
    TexelKernel(const LobeGrid& table, const TexelLayout& layout, bool placesByChannel);

    std::size_t weightsOfTexel() const { return table_.lobes() * layout_.channels; }
    std::size_t placesOfTexel() const {
        return table_.axes() * (placesByChannel_ ? layout_.channels : 1);
    }

    /// Texels [first, first + count) of a block: out[texel][layout.floats()].
    void run(const TexelBlock& block, std::size_t first, std::size_t count, float* out) const;

private:
    const LobeGrid& table_;
    const TexelLayout& layout_;
    bool placesByChannel_;
};

/// The largest magnitude, and whether all values are finite.
struct HalfRange {
    float largest = 0;
    bool finite = true;
};

/// Texels in float32, each of 4 * layers at a multiple of `stride`, as float16 (nearest even) in
/// layers: out[layer][texel] of four, the first texel of layer k at out + 4 * (k * pitch).
HalfRange toHalfLayers(const float* texels, std::size_t stride, std::size_t count,
                       std::size_t layers, std::uint16_t* out, std::size_t pitch);

/// out[k] = mean of the values of two neighbours, above[2 k], above[2 k + 1], and the two below; a
/// texel has `step` values.
void meanOfFour(const float* above, const float* below, std::size_t count, std::size_t step,
                float* out);

/// Parts of points along some directions, all of `length` floats, which is a multiple of 16.
///     y_r = <B_r, x>,   returns |x - sum_r y_r B_r|^2
float projectOnto(const float* directions, std::size_t count, std::size_t length, const float* x,
                  float* y);

/// Index of the nearest of many points, and the square of its distance. Of equally near ones the
/// first.
struct Nearest {
    std::uint32_t index = 0;
    float square = 0;
};
class NearestPoint {
public:
    /// points[point][dimension].
    NearestPoint(std::span<const float> points, std::size_t dimensions);
    Nearest operator()(const float* point) const;
    std::size_t count() const { return count_; }

private:
    std::size_t dimensions_, count_, padded_;
    std::vector<float> columns_;  ///< [dimension][point], padded by points far away
};

}  // namespace hshfit::inline material_maps
