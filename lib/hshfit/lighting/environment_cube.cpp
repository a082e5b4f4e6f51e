#include <hshfit/lighting/environment_cube.h>

#include <hshfit/light/light_nodes.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::lighting {
namespace {

struct CubePoint {
    std::size_t face;
    double a, b;  ///< in [-1, 1]
};

CubePoint cubePoint(const Direction& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    if (x >= y && x >= z)
        return d.x > 0 ? CubePoint{0, -d.z / x, -d.y / x} : CubePoint{1, d.z / x, -d.y / x};
    if (y >= z) return d.y > 0 ? CubePoint{2, d.x / y, d.z / y} : CubePoint{3, d.x / y, -d.z / y};
    return d.z > 0 ? CubePoint{4, d.x / z, -d.y / z} : CubePoint{5, -d.x / z, -d.y / z};
}

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

/// Nodes beyond a number as one for each cell of a cube's faces, at the middle of their flux: cells
/// are an eighth of a kernel's width, so that what is lost is of the order of a hundredth of its
/// curvature.
LightNodes merged(LightNodes nodes, std::size_t width) {
    const std::size_t cells = 6 * width * width;
    if (nodes.count() <= 2 * cells) return nodes;
    struct Cell {
        Direction sum{0, 0, 0};
        Rgb flux{};
    };
    std::vector<Cell> grid(cells);
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        const Direction d{nodes.x[k], nodes.y[k], nodes.z[k]};
        const CubePoint point = cubePoint(d);
        const auto place = [&](double a) {
            return std::min(static_cast<std::size_t>((a + 1) / 2 * static_cast<double>(width)),
                            width - 1);
        };
        Cell& cell = grid[(point.face * width + place(point.b)) * width + place(point.a)];
        double flux = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            cell.flux[c] += nodes.flux[c][k];
            flux += std::abs(nodes.flux[c][k]);
        }
        cell.sum.x += flux * d.x;
        cell.sum.y += flux * d.y;
        cell.sum.z += flux * d.z;
    }
    LightNodes result;
    for (const Cell& cell : grid) {
        const double length = std::sqrt(dot(cell.sum, cell.sum));
        if (length > 0)
            result.add({cell.sum.x / length, cell.sum.y / length, cell.sum.z / length}, cell.flux,
                       1);
    }
    return result;
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

EnvironmentCube::Level convolve(std::span<const Light> lights, std::size_t face, int order,
                                const std::function<double(double)>& kernel) {
    std::vector<LightNodes> nodes;
    for (const Light& light : lights)
        nodes.push_back(merged(nodesOf(light, {}, order, 0), 2 * face));
    EnvironmentCube::Level level{.face = face, .rgb = std::vector<float>(18 * face * face)};
    tbb::parallel_for(std::size_t{0}, 6 * face, [&](std::size_t line) {
        for (std::size_t column = 0; column < face; ++column) {
            Direction d = cubeDirection(line / face, centre(static_cast<double>(column), face),
                                        centre(static_cast<double>(line % face), face));
            const double length = std::sqrt(dot(d, d));
            d = {d.x / length, d.y / length, d.z / length};
            Rgb sum{};
            for (const LightNodes& part : nodes) {
                for (std::size_t k = 0; k < part.count(); ++k) {
                    const double weight =
                        kernel(d.x * part.x[k] + d.y * part.y[k] + d.z * part.z[k]);
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * part.flux[c][k];
                }
            }
            for (std::size_t c = 0; c < 3; ++c)
                level.rgb[3 * (line * face + column) + c] = static_cast<float>(sum[c]);
        }
    });
    return level;
}

}  // namespace hshfit::lighting
