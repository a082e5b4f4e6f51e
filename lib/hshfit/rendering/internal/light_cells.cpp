#include <hshfit/rendering/internal/light_cells.h>

#include <hshfit/light/light_samples.h>
#include <hshfit/rendering/internal/even_light.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::inline rendering {
namespace {

/// Columns of a sky's picture.
constexpr std::size_t skyColumns = 1024;

constexpr double widest = 0.35;
/// Pixels of a picture whose directions are kept.
constexpr std::size_t mostKept = std::size_t{1} << 22;
/// Pixels are cut in two this often, in each direction.
constexpr double narrowest = 1.0 / 16;

double grey(const Rgb& flux) {
    return flux[0] + flux[1] + flux[2];
}

}  // namespace

Light skyPicture(std::span<const Light> lights) {
    PictureLight picture{.file = "sky", .width = skyColumns, .height = skyColumns / 2, .rgb = {}};
    picture.rgb.resize(3 * picture.width * picture.height);
    tbb::parallel_for(std::size_t{0}, picture.height, [&](std::size_t row) {
        float* rgb = picture.rgb.data() + 3 * row * picture.width;
        for (std::size_t column = 0; column < picture.width; ++column) {
            const Direction d = directionOf(picture, static_cast<double>(column) + 0.5,
                                            static_cast<double>(row) + 0.5);
            for (const double value : radianceFrom(lights, d)) *rgb++ = static_cast<float>(value);
        }
    });
    return picture;
}

std::vector<Light> withOneSky(std::span<const Light> lights) {
    std::vector<Light> skies, even, result;
    for (const Light& light : lights) {
        if (const auto radiance = evenRadianceOf(light))
            even.push_back(DiscLight{{0, 0, 1}, pi, *radiance});
        else
            (std::holds_alternative<SkyLight>(light) ? skies : result).push_back(light);
    }
    std::vector<Light>& to = skies.empty() ? result : skies;
    to.insert(to.end(), even.begin(), even.end());
    if (!skies.empty()) result.push_back(skyPicture(skies));
    return result;
}

LightCells::LightCells(std::vector<Light> lights, double finest)
    : finest_(finest), lights_(std::move(lights)), trees_(lights_.size()) {
    for (std::size_t k = 0; k < lights_.size(); ++k) {
        const auto* picture = std::get_if<PictureLight>(&lights_[k]);
        if (!picture) continue;
        addPyramid(*picture, trees_[k]);
        const LightCell root = pictureCell(k, static_cast<int>(trees_[k].levels.size()), 0, 0);
        addCoarse(root, grey(root.flux));
    }
}

void LightCells::addCoarse(const LightCell& cell, double total) {
    const double share = total > 0 ? grey(cell.flux) / total : 0;
    if (!(share > 0)) return;
    std::array<LightCell, 4> parts;
    const bool cut = cell.width > widest || share * cell.width > finest_;
    // Pixels stay whole: coarser ones are cut by need.
    if (cut && cell.level > 0) {
        const std::size_t count = split(cell, parts);
        for (std::size_t k = 0; k < count; ++k) addCoarse(parts[k], total);
        if (count > 0) return;
    }
    coarse_.push_back(cell);
}

LightCells::Sum LightCells::pixelSum(const PictureLight& light, const PictureGeometry& geometry,
                                     std::size_t column, std::size_t row) const {
    Sum sum{};
    const float* rgb = light.rgb.data() + 3 * (row * light.width + column);
    if (!(rgb[0] + rgb[1] + rgb[2] > 0)) return sum;
    const double omega = geometry.solidAngle(column, row);
    const Direction d =
        directionOf(light, static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
    double all = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        sum.flux[c] = static_cast<float>(rgb[c] * omega);
        all += rgb[c] * omega;
    }
    sum.direction[0] = static_cast<float>(all * d.x);
    sum.direction[1] = static_cast<float>(all * d.y);
    sum.direction[2] = static_cast<float>(all * d.z);
    return sum;
}

LightCells::Sum LightCells::towards(Sum sum) {
    float* d = sum.direction;
    const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
    for (std::size_t c = 0; c < 3; ++c)
        d[c] = length > 0 ? static_cast<float>(d[c] / length) : 0.0F;
    return sum;
}

void LightCells::addPyramid(const PictureLight& light, Tree& tree) const {
    tree.geometry = geometryOf(light);
    std::size_t width = light.width, height = light.height;
    while (width > 1 || height > 1) {
        Level level{(width + 1) / 2, (height + 1) / 2, {}};
        level.sums.resize(level.width * level.height);
        for (std::size_t row = 0; row < height; ++row) {
            for (std::size_t column = 0; column < width; ++column) {
                const Sum part = tree.levels.empty()
                                     ? pixelSum(light, tree.geometry, column, row)
                                     : tree.levels.back().sums[row * width + column];
                Sum& to = level.sums[row / 2 * level.width + column / 2];
                for (std::size_t c = 0; c < 3; ++c) {
                    to.flux[c] += part.flux[c];
                    to.direction[c] += part.direction[c];
                }
            }
        }
        width = level.width;
        height = level.height;
        tree.levels.push_back(std::move(level));
    }
    for (Level& level : tree.levels)
        std::ranges::transform(level.sums, level.sums.begin(), towards);
    if (light.width * light.height <= mostKept) {
        for (std::size_t row = 0; row < light.height; ++row) {
            for (std::size_t column = 0; column < light.width; ++column)
                tree.pixels.push_back(towards(pixelSum(light, tree.geometry, column, row)));
        }
    }
    for (std::size_t k = 0; k <= tree.levels.size(); ++k)
        tree.widths.push_back(tree.geometry.pixelAngle() * std::exp2(static_cast<double>(k)));
}

LightCell LightCells::pictureCell(std::size_t light, int level, std::size_t column,
                                  std::size_t row) const {
    const auto& picture = std::get<PictureLight>(lights_[light]);
    const Tree& tree = trees_[light];
    Sum sum{};
    if (level == 0 && tree.pixels.empty()) {
        sum = towards(pixelSum(picture, tree.geometry, column, row));
    } else if (level == 0) {
        sum = tree.pixels[row * picture.width + column];
    } else {
        const Level& from = tree.levels[static_cast<std::size_t>(level - 1)];
        sum = from.sums[row * from.width + column];
    }
    return {.direction = {sum.direction[0], sum.direction[1], sum.direction[2]},
            .flux = {sum.flux[0], sum.flux[1], sum.flux[2]},
            .width = tree.widths[static_cast<std::size_t>(level)],
            .light = light,
            .level = level,
            .u = static_cast<double>(column),
            .v = static_cast<double>(row)};
}

std::size_t LightCells::splitPixel(const LightCell& cell, std::array<LightCell, 4>& parts) const {
    const double half = cell.size / 2;
    if (half < narrowest) return 0;
    const auto& picture = std::get<PictureLight>(lights_[cell.light]);
    const auto column = static_cast<std::size_t>(cell.u), row = static_cast<std::size_t>(cell.v);
    const float* rgb = picture.rgb.data() + 3 * (row * picture.width + column);
    // A picture of as many more pixels has the solid angles of the parts.
    const auto finer = static_cast<std::size_t>(1 / half);
    const PictureGeometry parted{picture.layout, picture.width * finer, picture.height * finer};
    for (std::size_t k = 0; k < 4; ++k) {
        LightCell& part = parts[k];
        part = cell;
        part.level = -1;
        part.size = half;
        part.width = cell.width / 2;
        part.u += k % 2 == 1 ? half : 0;
        part.v += k / 2 == 1 ? half : 0;
        part.direction = directionOf(picture, part.u + half / 2, part.v + half / 2);
        const double omega = parted.solidAngle(static_cast<std::size_t>(part.u / half),
                                               static_cast<std::size_t>(part.v / half));
        for (std::size_t c = 0; c < 3; ++c) part.flux[c] = rgb[c] * omega;
    }
    return 4;
}

std::size_t LightCells::split(const LightCell& cell, std::array<LightCell, 4>& parts) const {
    std::size_t count = 0;
    if (cell.level <= 0) return splitPixel(cell, parts);
    const auto& picture = std::get<PictureLight>(lights_[cell.light]);
    const Tree& tree = trees_[cell.light];
    const auto below = static_cast<std::size_t>(cell.level - 1);
    const std::size_t width = below == 0 ? picture.width : tree.levels[below - 1].width;
    const std::size_t height = below == 0 ? picture.height : tree.levels[below - 1].height;
    for (std::size_t row : {0, 1}) {
        for (std::size_t column : {0, 1}) {
            const std::size_t x = 2 * static_cast<std::size_t>(cell.u) + column;
            const std::size_t y = 2 * static_cast<std::size_t>(cell.v) + row;
            if (x >= width || y >= height) continue;
            parts[count] = pictureCell(cell.light, cell.level - 1, x, y);
            if (grey(parts[count].flux) > 0) ++count;
        }
    }
    return count;
}

}  // namespace hshfit::inline rendering
