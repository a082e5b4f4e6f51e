#include <hshfit/material_maps/internal/level_texels.h>

#include <algorithm>

namespace hshfit::inline material_maps {

LevelTexels LevelTexels::mean(std::size_t across, std::size_t down) const {
    LevelTexels out{.width = width / across, .height = height / down, .step = step};
    out.values.resize(out.count() * step);
    const float share = 1.0F / static_cast<float>(across * down);
    for (std::size_t r = 0; r < out.height; ++r) {
        const float* above = row(r * down);
        const float* below = row(r * down + down - 1);
        for (std::size_t c = 0; c < out.width; ++c) {
            const std::size_t left = c * across * step, right = (c * across + across - 1) * step;
            float* to = out.row(r) + c * step;
            for (std::size_t k = 0; k < step; ++k) {
                float sum = above[left + k];
                if (across == 2) sum += above[right + k];
                if (down == 2) sum += below[left + k];
                if (across == 2 && down == 2) sum += below[right + k];
                to[k] = sum * share;
            }
        }
    }
    return out;
}

LevelTexels LevelTexels::largestOf(std::size_t across, std::size_t down) const {
    LevelTexels out{.width = width / across, .height = height / down, .step = 1};
    out.values.resize(out.count());
    for (std::size_t r = 0; r < out.height; ++r) {
        for (std::size_t c = 0; c < out.width; ++c) {
            float most = 0;
            for (std::size_t y = 0; y < down; ++y)
                for (std::size_t x = 0; x < across; ++x)
                    most = std::max(most, row(r * down + y)[c * across + x]);
            out.row(r)[c] = most;
        }
    }
    return out;
}

const float* LevelTexels::append(const float* from, std::size_t columns, std::size_t rows) {
    width = columns;
    height += rows;
    const float* end = from + columns * rows * step;
    values.insert(values.end(), from, end);
    return end;
}

}  // namespace hshfit::inline material_maps
