#include <hshfit/lighting/environment_cube.h>

#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/light_nodes.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/light/sky.h>
#include <hshfit/lighting/internal/light_pyramid.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::lighting {
namespace {

double centre(double k, std::size_t face) {
    return (2 * k + 1) / static_cast<double>(face) - 1;
}

/// The texel at (column, row), which may lie one beyond the face's edge.
const float* texel(const EnvironmentCube::Level& level, std::size_t face, long column, long row) {
    const auto width = static_cast<long>(level.face);
    if (column < 0 || row < 0 || column >= width || row >= width) {
        const CubePoint there =
            cubePoint(cubeDirection(face, centre(static_cast<double>(column), level.face),
                                    centre(static_cast<double>(row), level.face)));
        const auto place = [&](double a) {
            return std::clamp(static_cast<long>((a + 1) / 2 * static_cast<double>(width)), 0L,
                              width - 1);
        };
        face = there.face;
        column = place(there.a);
        row = place(there.b);
    }
    const auto n =
        static_cast<std::size_t>((static_cast<long>(face) * width + row) * width + column);
    return level.rgb.data() + 3 * n;
}

Rgb bilinear(const EnvironmentCube::Level& level, const CubePoint& point) {
    const auto width = static_cast<double>(level.face);
    const double x = (point.a + 1) / 2 * width - 0.5, y = (point.b + 1) / 2 * width - 0.5;
    const auto column = static_cast<long>(std::floor(x)), row = static_cast<long>(std::floor(y));
    const double u = x - static_cast<double>(column), v = y - static_cast<double>(row);
    Rgb sum{};
    for (long j = 0; j < 2; ++j) {
        for (long i = 0; i < 2; ++i) {
            const double weight = (i ? u : 1 - u) * (j ? v : 1 - v);
            const float* rgb = texel(level, point.face, column + i, row + j);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * rgb[c];
        }
    }
    return sum;
}

}  // namespace

Direction cubeDirection(std::size_t face, double a, double b) {
    switch (face) {
        case 0:
            return {1, -b, -a};
        case 1:
            return {-1, -b, a};
        case 2:
            return {a, 1, b};
        case 3:
            return {a, -1, -b};
        case 4:
            return {a, -b, 1};
        default:
            return {-a, -b, -1};
    }
}

std::size_t EnvironmentCube::texels() const {
    std::size_t count = 0;
    for (const Level& level : levels) count += 6 * level.face * level.face;
    return count;
}

Rgb EnvironmentCube::at(const Direction& world, double level) const {
    const double place = std::clamp(level, 0.0, static_cast<double>(levels.size() - 1));
    const auto first = std::min(static_cast<std::size_t>(place), levels.size() - 1);
    const double share = place - static_cast<double>(first);
    const CubePoint point = cubePoint(world);
    Rgb result = bilinear(levels[first], point);
    if (share == 0) return result;
    const Rgb next = bilinear(levels[first + 1], point);
    for (std::size_t c = 0; c < 3; ++c) result[c] += share * (next[c] - result[c]);
    return result;
}

namespace {

Direction unitAt(std::size_t face, double a, double b) {
    const Direction d = cubeDirection(face, a, b);
    const double length = std::sqrt(dot(d, d));
    return {d.x / length, d.y / length, d.z / length};
}

/// Calls `at` with the place of each texel, its face, column and row, in parallel.
template <class At>
void overTexels(std::size_t face, const At& at) {
    tbb::parallel_for(std::size_t{0}, 6 * face, [&](std::size_t line) {
        for (std::size_t column = 0; column < face; ++column)
            at(line * face + column, line / face, static_cast<double>(column),
               static_cast<double>(line % face));
    });
}

/// Blocks of texels, neighbours enough to be walked together.
EnvironmentCube::Level convolved(const std::vector<LightPyramid>& pyramids, std::size_t face,
                                 const PyramidKernel& kernel) {
    EnvironmentCube::Level level{.face = face, .rgb = std::vector<float>(18 * face * face)};
    constexpr std::size_t wide = 4, high = LightPyramid::axesAtOnce / wide;
    const std::size_t blocks = (face + high - 1) / high;
    tbb::parallel_for(std::size_t{0}, 6 * blocks, [&](std::size_t line) {
        const std::size_t side = line / blocks, row = high * (line % blocks);
        for (std::size_t column = 0; column < face; column += wide) {
            LightPyramid::Axes axes{};
            LightPyramid::Sums sums{};
            std::array<std::size_t, LightPyramid::axesAtOnce> places{};
            for (std::size_t k = 0; k < axes.size(); ++k) {
                // Beyond the face's edge its last texel is taken again.
                const std::size_t i = std::min(column + k % wide, face - 1),
                                  j = std::min(row + k / wide, face - 1);
                axes[k] = unitAt(side, centre(static_cast<double>(i), face),
                                 centre(static_cast<double>(j), face));
                places[k] = (side * face + j) * face + i;
            }
            for (const LightPyramid& part : pyramids) part.add(axes, kernel, sums);
            for (std::size_t k = 0; k < axes.size(); ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    level.rgb[3 * places[k] + c] = static_cast<float>(sums[k][c]);
        }
    });
    return level;
}

/// The solid angle of a texel about its middle: the area over the cube of the distance.
double solidAngle(std::size_t face, double column, double row) {
    const double a = centre(column, face), b = centre(row, face);
    const double side = 2 / static_cast<double>(face);
    return side * side / std::pow(1 + a * a + b * b, 1.5);
}

/// The radiance of lights that have one in every direction.
struct RadianceAt {
    Direction d;

    bool operator()(const SkyLight& light, Rgb& sum) const {
        return add(radianceOf(light, d), sum);
    }
    bool operator()(const PictureLight& light, Rgb& sum) const {
        return add(radianceOf(light, d), sum);
    }
    bool operator()(const CoefficientLight& light, Rgb& sum) const {
        return add(radianceOf(light, d), sum);
    }
    bool operator()(const auto&, Rgb&) const { return false; }

    static bool add(const Rgb& own, Rgb& sum) {
        for (std::size_t c = 0; c < 3; ++c) sum[c] += own[c] / 4;
        return true;
    }
};

}  // namespace

EnvironmentCube::Level convolve(std::span<const Light> lights, std::size_t face, int order,
                                const LobeKernel::Scaled& kernel) {
    std::vector<LightPyramid> pyramids;
    for (const Light& light : lights) pyramids.emplace_back(nodesOf(light, {}, order, 0), 2 * face);
    return convolved(pyramids, face, PyramidKernel(kernel));
}

EnvironmentCube::Level convolve(const EnvironmentCube::Level& light, std::size_t face,
                                const LobeKernel::Scaled& kernel, double core) {
    LightNodes nodes;
    for (std::size_t place = 0; place < light.rgb.size() / 3; ++place) {
        const std::size_t side = place / (light.face * light.face);
        const auto column = static_cast<double>(place % light.face),
                   row = static_cast<double>(place / light.face % light.face);
        const float* rgb = &light.rgb[3 * place];
        nodes.add(unitAt(side, centre(column, light.face), centre(row, light.face)),
                  {rgb[0], rgb[1], rgb[2]}, solidAngle(light.face, column, row));
    }
    std::vector<LightPyramid> pyramids;
    pyramids.emplace_back(nodes, 2 * face);
    return convolved(pyramids, face, PyramidKernel(kernel, core));
}

EnvironmentCube::Level rasterised(std::span<const Light> lights, std::size_t face) {
    constexpr int order = 512;  // of nodes that fill texels
    EnvironmentCube::Level level{.face = face, .rgb = std::vector<float>(18 * face * face)};
    overTexels(face, [&](std::size_t place, std::size_t side, double column, double row) {
        Rgb sum{};
        for (const double down : {-0.25, 0.25}) {
            for (const double right : {-0.25, 0.25}) {
                const RadianceAt here{
                    unitAt(side, centre(column + right, face), centre(row + down, face))};
                for (const Light& light : lights)
                    std::visit([&](const auto& one) { here(one, sum); }, light);
            }
        }
        for (std::size_t c = 0; c < 3; ++c) level.rgb[3 * place + c] = static_cast<float>(sum[c]);
    });
    for (const Light& light : lights) {
        Rgb none{};
        if (std::visit([&](const auto& one) { return RadianceAt{{0, 0, 1}}(one, none); }, light))
            continue;
        const LightNodes nodes = nodesOf(light, {}, order, 0);
        for (std::size_t k = 0; k < nodes.count(); ++k) {
            const CubePoint point = cubePoint({nodes.x[k], nodes.y[k], nodes.z[k]});
            const auto at = [&](double a) {
                return std::min(static_cast<std::size_t>((a + 1) / 2 * static_cast<double>(face)),
                                face - 1);
            };
            const std::size_t column = at(point.a), row = at(point.b);
            const double omega =
                solidAngle(face, static_cast<double>(column), static_cast<double>(row));
            for (std::size_t c = 0; c < 3; ++c)
                level.rgb[3 * ((point.face * face + row) * face + column) + c] +=
                    static_cast<float>(nodes.flux[c][k] / omega);
        }
    }
    return level;
}

}  // namespace hshfit::lighting
