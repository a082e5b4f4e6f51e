#include <hshfit/filtered_maps/filtered_map_writer.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::inline filtered_maps {
namespace {

/// Numbers [texel][count] as layers of a row, [layer][texel][4].
std::vector<std::byte> layersOf(std::span<const double> numbers, std::size_t count,
                                std::size_t layers, gpu::Number number) {
    const std::size_t width = numbers.size() / count;
    std::vector<double> values(layers * width * 4, 0.0);
    for (std::size_t x = 0; x < width; ++x)
        for (std::size_t k = 0; k < count; ++k)
            values[(k / 4 * width + x) * 4 + k % 4] = numbers[x * count + k];
    return gpu::encode(values, static_cast<int>(width), 1, layers, number).bytes;
}

}  // namespace

FilteredMapWriter::FilteredMapWriter(const FilteredSidecar& sidecar, const std::string& texture,
                                     const std::string& harmonics)
    : sidecar_(sidecar),
      texture_(texture, sidecar.number, sidecar.layers(), sidecar.levels,
               {.pairs = {{"hshfit:form", sidecar.form}}, .pastPageCache = false}) {
    if (sidecar.form != "harmonics") return;
    harmonics_ = std::make_unique<LevelFile>(
        harmonics, sidecar.number, sidecar.harmonicLayers(),
        std::vector<LevelSize>(sidecar.levels.begin() + 1, sidecar.levels.end()),
        LevelFileOptions{.pairs = {{"hshfit:form", "harmonics"}}, .pastPageCache = false});
}

void FilteredMapWriter::begin() {
    texture_.begin();
    if (harmonics_) harmonics_->begin();
}

void FilteredMapWriter::write(std::size_t level, std::size_t row, std::span<const double> texels) {
    const MipLayout& layout = sidecar_.layout;
    const std::size_t ellipse = layout.ellipseSize();
    const std::size_t count = texels.size() / sidecar_.levels[level].width;
    std::vector<double> first, rest;
    for (std::size_t at = 0; at < texels.size(); at += count) {
        const std::vector<double> stored = storedNumbers(texels.subspan(at, ellipse));
        first.insert(first.end(), stored.begin(), stored.end());
        if (harmonics_ && level > 0) {
            const auto more = texels.subspan(at + ellipse, layout.size() - ellipse);
            rest.insert(rest.end(), more.begin(), more.end());
        }
    }
    try {
        texture_.write(level, row, 1, layersOf(first, ellipse, sidecar_.layers(), sidecar_.number));
        if (!harmonics_ || level == 0) return;
        harmonics_->write(
            level - 1, row, 1,
            layersOf(rest, layout.size() - ellipse, sidecar_.harmonicLayers(), sidecar_.number));
    } catch (const NumericError& error) {
        throw NumericError(fmt::format("row {} of level {}: {}", row, level, error.what()));
    }
}

std::size_t FilteredMapWriter::bytes() const {
    return texture_.bytes() + (harmonics_ ? harmonics_->bytes() : 0);
}

}  // namespace hshfit::inline filtered_maps
