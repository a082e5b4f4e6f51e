#include <hshfit/filtered_maps/exports/ordinary_mips.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/gpu/containers/ktx2_image.h>
#include <hshfit/normal_filtering/mip_layout.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline filtered_maps::inline exports {
namespace {

using gpu::Blocks;
using gpu::BlockTexel;

/// Below this strength texels count as round.
constexpr double leastStrength = 0.02;

float coded(double value) {
    return static_cast<float>((value + 1) / 2);
}

BlockTexel normalTexel(const OrdinaryTexel& texel) {
    return {coded(texel.normal.x), coded(texel.normal.y), 0, 1};
}

BlockTexel roughnessTexel(const OrdinaryTexel& texel) {
    return {1, static_cast<float>(texel.roughness()), 1, 1};
}

BlockTexel anisotropyTexel(const OrdinaryTexel& texel) {
    return {coded(texel.direction[0]), coded(texel.direction[1]),
            static_cast<float>(texel.strength()), 1};
}

Direction normalOf(const BlockTexel& texel) {
    const double x = 2 * static_cast<double>(texel[0]) - 1,
                 y = 2 * static_cast<double>(texel[1]) - 1;
    return {x, y, std::sqrt(std::max(0.0, 1 - x * x - y * y))};
}

double normalError(const BlockTexel& found, const BlockTexel& wanted) {
    return angleBetween(normalOf(found), normalOf(wanted));
}

double roughnessError(const BlockTexel& found, const BlockTexel& wanted) {
    return std::abs(static_cast<double>(found[1] - wanted[1]));
}

/// The error of the strength, or the strength times the sine of the angle between the directions if
/// that is larger.
double anisotropyError(const BlockTexel& found, const BlockTexel& wanted) {
    const double x = 2 * static_cast<double>(found[0]) - 1,
                 y = 2 * static_cast<double>(found[1]) - 1,
                 along = 2 * static_cast<double>(wanted[0]) - 1,
                 aside = 2 * static_cast<double>(wanted[1]) - 1;
    const double length = std::hypot(x, y);
    const double across = length > 0 ? std::abs(x * aside - y * along) / length : 1;
    return std::max(std::abs(static_cast<double>(found[2] - wanted[2])),
                    static_cast<double>(wanted[2]) * across);
}

/// A direction and its opposite are the same: each texel takes that nearer to the common axis, so
/// that blocks and filters seldom mix opposites. The axis itself is taken on the side of `before`,
/// the axis of the level before, because filters mix levels too; it is returned.
std::array<double, 2> alignDirections(std::vector<OrdinaryTexel>& texels,
                                      const std::array<double, 2>& before) {
    double x = 0, y = 0;
    for (const OrdinaryTexel& texel : texels) {
        const auto& [c, s] = texel.direction;
        x += texel.strength() * (c * c - s * s);
        y += texel.strength() * 2 * c * s;
    }
    const double angle = std::atan2(y, x) / 2;
    std::array<double, 2> axis{std::cos(angle), std::sin(angle)};
    const auto alongside = [](std::array<double, 2>& one, const std::array<double, 2>& other) {
        if (one[0] * other[0] + one[1] * other[1] < 0) one = {-one[0], -one[1]};
    };
    alongside(axis, before);
    for (OrdinaryTexel& texel : texels) alongside(texel.direction, axis);
    return axis;
}

struct Kind {
    const char* role;
    Blocks blocks;
    BlockTexel (*texel)(const OrdinaryTexel&);
    double (*error)(const BlockTexel&, const BlockTexel&);
};

using Levels = std::vector<std::vector<OrdinaryTexel>>;

OrdinaryMips written(const Kind& kind, const FilteredMap& map, const Levels& levels,
                     const std::string& name, FileSet& files) {
    OrdinaryMips made{.role = kind.role, .path = name + "." + kind.role + ".ktx2"};
    const std::vector<LevelSize>& sizes = map.sidecar().levels;
    std::vector<std::vector<std::byte>> bytes;
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t level = 0; level < levels.size(); ++level) {
        std::vector<BlockTexel> texels;
        for (const OrdinaryTexel& texel : levels[level]) texels.push_back(kind.texel(texel));
        gpu::BlockPicture picture =
            gpu::encodeBlocks(kind.blocks, texels, sizes[level].width, sizes[level].height);
        for (std::size_t k = 0; k < texels.size(); ++k) {
            const double error = kind.error(picture.decoded[k], texels[k]);
            made.largestError = std::max(made.largestError, error);
            sum += error, ++count;
        }
        bytes.push_back(std::move(picture.bytes));
    }
    made.meanError = sum / static_cast<double>(count);
    const std::string file = gpu::ktx2File(
        {.blocks = kind.blocks, .width = sizes[0].width, .height = sizes[0].height}, bytes);
    files.write(made.path, file);
    made.bytes = file.size();
    return made;
}

}  // namespace

double OrdinaryTexel::roughness() const {
    return std::sqrt(shorter);
}

double OrdinaryTexel::strength() const {
    return shorter < 1 ? std::sqrt(std::clamp((longer - shorter) / (1 - shorter), 0.0, 1.0)) : 0;
}

OrdinaryTexel ordinaryTexel(std::span<const double> numbers) {
    OrdinaryTexel texel;
    const double* n = &numbers[MipLayout::normal];
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (length > 1e-6) texel.normal = {n[0] / length, n[1] / length, n[2] / length};
    const double *m = &numbers[MipLayout::plane], *s = &numbers[MipLayout::planeSquares],
                 *w = &numbers[MipLayout::widths];
    const double xx = w[0] + 2 * std::max(0.0, s[0] - m[0] * m[0]),
                 xy = w[1] + 2 * (s[1] - m[0] * m[1]),
                 yy = w[2] + 2 * std::max(0.0, s[2] - m[1] * m[1]);
    const double mean = (xx + yy) / 2, apart = std::hypot((xx - yy) / 2, xy);
    const auto width = [](double square) {
        return std::clamp(std::sqrt(std::max(0.0, square)), 0.0, 1.0);
    };
    texel.longer = width(mean + apart);
    texel.shorter = width(mean - apart);
    const double angle = apart > 0 ? std::atan2(xy, (xx - yy) / 2) / 2 : 0;
    texel.direction = {std::cos(angle), std::sin(angle)};
    return texel;
}

std::vector<OrdinaryMips> writeOrdinaryMips(const FilteredMap& map, const std::string& name,
                                            FileSet& files) {
    Levels levels;
    bool brushed = false;
    std::array<double, 2> axis{0, 0};
    for (std::size_t level = 0; level < map.sidecar().levels.size(); ++level) {
        const LevelSize& size = map.sidecar().levels[level];
        std::vector<OrdinaryTexel>& texels = levels.emplace_back();
        for (std::size_t row = 0; row < size.height; ++row)
            for (std::size_t column = 0; column < size.width; ++column) {
                texels.push_back(ordinaryTexel(map.numbers(level, column, row)));
                brushed = brushed || texels.back().strength() > leastStrength;
            }
        axis = alignDirections(texels, axis);
    }
    const Kind kinds[] = {{"normal", Blocks::bc5, normalTexel, normalError},
                          {"roughness", Blocks::bc7, roughnessTexel, roughnessError},
                          {"anisotropy", Blocks::bc7, anisotropyTexel, anisotropyError}};
    std::vector<OrdinaryMips> made;
    for (const Kind& kind : std::span(kinds).first(brushed ? 3 : 2))
        made.push_back(written(kind, map, levels, name, files));
    map.checkIntact();
    return made;
}

}  // namespace hshfit::inline filtered_maps::inline exports
