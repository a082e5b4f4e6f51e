#include <hshfit/lighting/environment_cube.h>

#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/light_nodes.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/light/sky.h>

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

/// A kernel, and the chord beyond which it has little of its integral, so that cells may grow there
/// in size over distance.
struct PyramidKernel {
    const LobeKernel::Scaled& kernel;
    double core = 2;

    /// The factor by which the square of size over distance may be larger, for the square of a
    /// chord.
    double growth(double squared) const { return std::clamp(squared / (core * core), 1.0, 16.0); }
};

/// Light as a pyramid over the cells of a cube's faces. Far from an axis a kernel about it varies
/// slowly, so that a cell is one node at the middle of its flux if it is small beside its distance.
class LightPyramid {
public:
    /// `width`: cells along a face in the finest level. Nodes that are many more than these cells
    /// are not kept: cells are an eighth of a kernel's width, so that what is lost is of the order
    /// of a hundredth of its curvature.
    LightPyramid(const LightNodes& nodes, std::size_t width) {
        const std::size_t cells = 6 * width * width;
        std::vector<std::size_t> cellOf(nodes.count());
        std::vector<Cell> finest(cells);
        for (std::size_t k = 0; k < nodes.count(); ++k) {
            const Direction d{nodes.x[k], nodes.y[k], nodes.z[k]};
            const CubePoint point = cubePoint(d);
            const auto place = [&](double a) {
                return std::min(static_cast<std::size_t>((a + 1) / 2 * static_cast<double>(width)),
                                width - 1);
            };
            cellOf[k] = (point.face * width + place(point.b)) * width + place(point.a);
            finest[cellOf[k]].add(d, {nodes.flux[0][k], nodes.flux[1][k], nodes.flux[2][k]});
        }
        if (nodes.count() <= 2 * cells) keep(nodes, cellOf, cells);
        levels_.push_back({width, std::move(finest)});
        while (levels_.back().width > 1) {
            const Level& below = levels_.back();
            Level level{(below.width + 1) / 2, {}};
            level.cells.resize(6 * level.width * level.width);
            for (std::size_t k = 0; k < below.cells.size(); ++k) {
                const std::size_t column = k % below.width, row = k / below.width % below.width,
                                  face = k / (below.width * below.width);
                level.cells[(face * level.width + row / 2) * level.width + column / 2].add(
                    below.cells[k]);
            }
            levels_.push_back(std::move(level));
        }
        for (Level& level : levels_)
            for (Cell& cell : level.cells) cell.centre();
    }

    /// The sum of flux times kernel(cosine) about an axis.
    Rgb sum(const Direction& axis, const PyramidKernel& kernel) const {
        Rgb sum{};
        for (std::size_t face = 0; face < 6; ++face)
            add(axis, kernel, levels_.size() - 1, face, 0, 0, sum);
        return sum;
    }

private:
    /// The size of a cell over its distance from the axis, at which it is one node.
    static constexpr double slender = 1.0 / 7;

    struct Cell {
        Direction sum{0, 0, 0};  ///< of |flux| times direction; after `centre` the direction
        Rgb flux{};
        bool any = false;

        void add(const Direction& d, const Rgb& f) {
            const double size = std::abs(f[0]) + std::abs(f[1]) + std::abs(f[2]);
            add({.sum = {size * d.x, size * d.y, size * d.z}, .flux = f});
        }
        void add(const Cell& other) {
            sum.x += other.sum.x, sum.y += other.sum.y, sum.z += other.sum.z;
            for (std::size_t c = 0; c < 3; ++c) flux[c] += other.flux[c];
        }
        void centre() {
            const double length = std::sqrt(dot(sum, sum));
            any = length > 0;
            if (any) sum = {sum.x / length, sum.y / length, sum.z / length};
        }
    };
    struct Level {
        std::size_t width = 0;
        std::vector<Cell> cells;  ///< [face][row][column]
    };

    void keep(const LightNodes& nodes, const std::vector<std::size_t>& cellOf, std::size_t cells) {
        first_.assign(cells + 1, 0);
        for (const std::size_t cell : cellOf) ++first_[cell + 1];
        for (std::size_t k = 0; k < cells; ++k) first_[k + 1] += first_[k];
        nodes_.resize(nodes.count());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (std::size_t k = 0; k < nodes.count(); ++k)
            nodes_[next[cellOf[k]]++] = {{nodes.x[k], nodes.y[k], nodes.z[k]},
                                         {nodes.flux[0][k], nodes.flux[1][k], nodes.flux[2][k]},
                                         true};
    }

    static void addNode(const Direction& axis, const PyramidKernel& kernel, const Cell& node,
                        Rgb& sum) {
        const double weight =
            kernel.kernel.at(axis.x * node.sum.x + axis.y * node.sum.y + axis.z * node.sum.z);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * node.flux[c];
    }

    void add(const Direction& axis, const PyramidKernel& kernel, std::size_t level,
             std::size_t face, std::size_t row, std::size_t column, Rgb& sum) const {
        const Level& own = levels_[level];
        const std::size_t place = (face * own.width + row) * own.width + column;
        const Cell& cell = own.cells[place];
        if (!cell.any) return;
        const double size = 2 / static_cast<double>(own.width);
        // The square of the chord.
        const double squared =
            2 - 2 * (axis.x * cell.sum.x + axis.y * cell.sum.y + axis.z * cell.sum.z);
        if (size * size <= slender * slender * squared * kernel.growth(squared))
            return addNode(axis, kernel, cell, sum);
        if (level == 0) {
            if (first_.empty()) return addNode(axis, kernel, cell, sum);
            for (std::size_t k = first_[place]; k < first_[place + 1]; ++k)
                addNode(axis, kernel, nodes_[k], sum);
            return;
        }
        const std::size_t width = levels_[level - 1].width;
        for (std::size_t j = 2 * row; j < std::min(width, 2 * row + 2); ++j)
            for (std::size_t i = 2 * column; i < std::min(width, 2 * column + 2); ++i)
                add(axis, kernel, level - 1, face, j, i, sum);
    }

    std::vector<Level> levels_;  ///< the finest first
    std::vector<Cell> nodes_;    ///< by cells of the finest level
    std::vector<std::size_t> first_;
};

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

EnvironmentCube::Level convolved(const std::vector<LightPyramid>& pyramids, std::size_t face,
                                 const PyramidKernel& kernel) {
    EnvironmentCube::Level level{.face = face, .rgb = std::vector<float>(18 * face * face)};
    overTexels(face, [&](std::size_t place, std::size_t side, double column, double row) {
        const Direction d = unitAt(side, centre(column, face), centre(row, face));
        Rgb sum{};
        for (const LightPyramid& part : pyramids) {
            const Rgb own = part.sum(d, kernel);
            for (std::size_t c = 0; c < 3; ++c) sum[c] += own[c];
        }
        for (std::size_t c = 0; c < 3; ++c) level.rgb[3 * place + c] = static_cast<float>(sum[c]);
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
    return convolved(pyramids, face, {kernel});
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
    return convolved(pyramids, face, {kernel, core});
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
