#include <hshfit/material_maps/texel_source.h>

#include <hshfit/each_in_parallel.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline material_maps {

std::vector<LevelSize> levelSizes(std::size_t width, std::size_t height, bool mips) {
    std::vector<LevelSize> sizes{{width, height}};
    const auto halves = [](std::size_t side) { return side == 1 || side % 2 == 0; };
    while (mips && halves(width) && halves(height) && (width > 1 || height > 1)) {
        width = std::max<std::size_t>(width / 2, 1);
        height = std::max<std::size_t>(height / 2, 1);
        sizes.push_back({width, height});
    }
    return sizes;
}

std::vector<float> sampleTexels(TexelSource& source, std::size_t most, Processes& processes) {
    const std::size_t width = source.width(), height = source.height();
    const double share =
        std::sqrt(std::min(1.0, static_cast<double>(most) /
                                    (static_cast<double>(width) * static_cast<double>(height))));
    const auto of = [&](std::size_t side) {
        return std::clamp<std::size_t>(
            static_cast<std::size_t>(std::floor(share * static_cast<double>(side))), 1, side);
    };
    const std::size_t columns = of(width), rows = of(height);
    const std::size_t floats = source.layout().floats();
    std::vector<float> texels(rows * columns * floats);
    const ItemRange mine = processes.share(rows);
    for (std::size_t r = mine.first; r < mine.last; ++r) {
        const std::size_t row = (2 * r + 1) * height / (2 * rows);
        const auto band = source.band(row, row + 1);
        eachInParallel((columns + 63) / 64, [&](std::size_t part) {
            for (std::size_t c = part * 64; c < std::min(part * 64 + 64, columns); ++c) {
                const std::size_t column = (2 * c + 1) * width / (2 * columns);
                band->texels(row, column, 1, texels.data() + (r * columns + c) * floats);
            }
        });
    }
    gatherValues(processes, rows, texels);
    return texels;
}

}  // namespace hshfit::inline material_maps
