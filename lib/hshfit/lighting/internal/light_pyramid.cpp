#include <hshfit/lighting/internal/light_pyramid.h>

#include <cmath>
#include <utility>

namespace hshfit::lighting {

CubePoint cubePoint(const Direction& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    if (x >= y && x >= z)
        return d.x > 0 ? CubePoint{0, -d.z / x, -d.y / x} : CubePoint{1, d.z / x, -d.y / x};
    if (y >= z) return d.y > 0 ? CubePoint{2, d.x / y, d.z / y} : CubePoint{3, d.x / y, -d.z / y};
    return d.z > 0 ? CubePoint{4, d.x / z, -d.y / z} : CubePoint{5, -d.x / z, -d.y / z};
}

void LightPyramid::Cell::add(const Direction& d, const Rgb& f) {
    const double size = std::abs(f[0]) + std::abs(f[1]) + std::abs(f[2]);
    add({.sum = {size * d.x, size * d.y, size * d.z}, .flux = f});
}

void LightPyramid::Cell::add(const Cell& other) {
    sum.x += other.sum.x, sum.y += other.sum.y, sum.z += other.sum.z;
    for (std::size_t c = 0; c < 3; ++c) flux[c] += other.flux[c];
}

void LightPyramid::Cell::centre() {
    const double length = std::sqrt(dot(sum, sum));
    any = length > 0;
    if (any) sum = {sum.x / length, sum.y / length, sum.z / length};
}

LightPyramid::LightPyramid(const LightNodes& all, std::size_t width) {
    const std::size_t cells = 6 * width * width;
    std::vector<std::size_t> cellOf(all.count());
    std::vector<Cell> finest(cells);
    for (std::size_t k = 0; k < all.count(); ++k) {
        const Direction d{all.x[k], all.y[k], all.z[k]};
        const CubePoint point = cubePoint(d);
        const auto place = [&](double a) {
            return std::min(static_cast<std::size_t>((a + 1) / 2 * static_cast<double>(width)),
                            width - 1);
        };
        cellOf[k] = (point.face * width + place(point.b)) * width + place(point.a);
        finest[cellOf[k]].add(d, {all.flux[0][k], all.flux[1][k], all.flux[2][k]});
    }
    if (all.count() <= 2 * cells) keep(all, cellOf, cells);
    levels.push_back({width, std::move(finest)});
    while (levels.back().width > 1) {
        const Level& below = levels.back();
        Level level{(below.width + 1) / 2, {}};
        level.cells.resize(6 * level.width * level.width);
        for (std::size_t k = 0; k < below.cells.size(); ++k) {
            const std::size_t column = k % below.width, row = k / below.width % below.width,
                              face = k / (below.width * below.width);
            level.cells[(face * level.width + row / 2) * level.width + column / 2].add(
                below.cells[k]);
        }
        levels.push_back(std::move(level));
    }
    for (Level& level : levels)
        for (Cell& cell : level.cells) cell.centre();
}

void LightPyramid::keep(const LightNodes& all, const std::vector<std::size_t>& cellOf,
                        std::size_t cells) {
    first.assign(cells + 1, 0);
    for (const std::size_t cell : cellOf) ++first[cell + 1];
    for (std::size_t k = 0; k < cells; ++k) first[k + 1] += first[k];
    nodes.resize(all.count());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t k = 0; k < all.count(); ++k)
        nodes[next[cellOf[k]]++] = {
            {all.x[k], all.y[k], all.z[k]}, {all.flux[0][k], all.flux[1][k], all.flux[2][k]}, true};
}

}  // namespace hshfit::lighting
