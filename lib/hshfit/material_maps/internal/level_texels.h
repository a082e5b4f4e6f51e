#pragma once

#include <cstddef>
#include <vector>

namespace hshfit::inline material_maps {

/// Rows of a level in float32: values[(row * width + column) * step + k].
struct LevelTexels {
    std::size_t width = 0, height = 0, step = 1;
    std::vector<float> values = {};

    std::size_t count() const { return width * height; }
    float* row(std::size_t r) { return values.data() + r * width * step; }
    const float* row(std::size_t r) const { return values.data() + r * width * step; }

    /// The level of the means of across x down texels, each 1 or 2.
    LevelTexels mean(std::size_t across, std::size_t down) const;
    /// The same for the largest, step 1.
    LevelTexels largestOf(std::size_t across, std::size_t down) const;
    /// Rows more at the bottom; returns where they end in `from`.
    const float* append(const float* from, std::size_t columns, std::size_t rows);
};

}  // namespace hshfit::inline material_maps
