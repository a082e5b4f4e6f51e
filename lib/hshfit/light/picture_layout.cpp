#include <hshfit/light/picture_layout.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace hshfit::inline light {
namespace {

constexpr LayoutName names[] = {
    {PictureLayout::latlong, "latlong", "latitude and longitude"},
    {PictureLayout::angular, "angular", "Debevec's angular map"},
    {PictureLayout::mirrorBall, "mirror-ball", "photograph of a mirrored ball"},
    {PictureLayout::cross, "cross", "unfolded cube"},
    {PictureLayout::faces, "faces", "six faces of a cube in a row or a column"},
    {PictureLayout::dome, "dome", "the upper hemisphere, a fisheye or the half of latlong"},
    {PictureLayout::equalArea, "equal-area", "pbrt's octahedron in a square"},
};

/// `value` within [0, limit), by so much that it stays below after whole faces are added.
double below(double value, std::size_t limit) {
    return std::clamp(value, 0.0, static_cast<double>(limit) * (1 - 0x1p-40));
}

// --- discs ----------------------------------------------------------------------------------

/// A point of the unit disc, v up.
struct DiscPoint {
    double u, v;
};

Direction fromAngular(DiscPoint p) {
    const double r = std::hypot(p.u, p.v), theta = pi * std::min(r, 1.0);
    // sin(theta) / r, with its limit in the middle.
    const double across = r > 0 ? std::sin(theta) / r : pi;
    return {std::cos(theta), -across * p.u, across * p.v};
}
DiscPoint toAngular(const Direction& d) {
    const double across = std::hypot(d.y, d.z), r = std::atan2(across, d.x) / pi;
    if (!(across > 0)) return {d.x > 0 ? 0.0 : 1.0, 0};
    return {-d.y / across * r, d.z / across * r};
}

Direction fromMirrorBall(DiscPoint p) {
    const double squared = std::min(p.u * p.u + p.v * p.v, 1.0);
    // The camera's direction (-1, 0, 0), mirrored about the normal (-depth, -u, v).
    const double depth = std::sqrt(1 - squared);
    return {1 - 2 * depth * depth, -2 * depth * p.u, 2 * depth * p.v};
}
DiscPoint toMirrorBall(const Direction& d) {
    // The normal halves the angle between d and the camera's direction; 1 - d.x without
    // cancellation.
    const double squared = d.y * d.y + d.z * d.z;
    const double depth = d.x > 0 ? squared / (1 + d.x) : 1 - d.x;
    const double length = std::sqrt(depth * depth + squared);
    if (!(length > 0)) return {1, 0};
    return {-d.y / length, d.z / length};
}

Direction fromDome(DiscPoint p) {
    const double r = std::hypot(p.u, p.v), theta = pi / 2 * std::min(r, 1.0);
    const double across = r > 0 ? std::sin(theta) / r : pi / 2;
    return {-across * p.v, -across * p.u, std::cos(theta)};
}
DiscPoint toDome(const Direction& d) {
    const double across = std::hypot(d.x, d.y), r = std::atan2(across, d.z) / (pi / 2);
    if (!(across > 0)) return {d.z > 0 ? 0.0 : 1.0, 0};
    return {-d.y / across * r, -d.x / across * r};
}

/// Solid angle per area of the unit disc.
double discDensity(PictureLayout layout, double u, double v) {
    if (layout == PictureLayout::mirrorBall) return 4;
    const double r = std::hypot(u, v), rim = layout == PictureLayout::dome ? pi / 2 : pi;
    if (r >= 1) return 0;
    return r > 0 ? rim * std::sin(rim * r) / r : rim * rim;
}

double discSolidAngle(const PictureGeometry& g, std::size_t column, std::size_t row) {
    const double w = 2 / static_cast<double>(g.width), h = 2 / static_cast<double>(g.height);
    const double u = w * static_cast<double>(column) - 1, v = h * static_cast<double>(row) - 1;
    const auto furthest = [](double a, double step) {
        return std::max(std::abs(a), std::abs(a + step));
    };
    const auto nearest = [](double a, double step) {
        return a < 0 && a + step > 0 ? 0 : std::min(std::abs(a), std::abs(a + step));
    };
    if (std::hypot(nearest(u, w), nearest(v, h)) >= 1) return 0;
    double sum = 0;
    if (std::hypot(furthest(u, w), furthest(v, h)) <= 1) {
        const double gauss = 0.5 / std::sqrt(3.0);
        for (const double a : {0.5 - gauss, 0.5 + gauss}) {
            for (const double b : {0.5 - gauss, 0.5 + gauss}) {
                sum += discDensity(g.layout, u + a * w, v + b * h) / 4;
            }
        }
        return sum * w * h;
    }
    // On the rim: strips, each cut off at the rim.
    constexpr int strips = 64;
    for (int k = 0; k < strips; ++k) {
        const double x = u + w * (k + 0.5) / strips;
        const double rim = std::sqrt(std::max(1 - x * x, 0.0));
        const double low = std::max(v, -rim), high = std::min(v + h, rim);
        if (high > low) sum += (high - low) * discDensity(g.layout, x, (low + high) / 2);
    }
    return sum * w / strips;
}

// --- the square of equal area ---------------------------------------------------------------

/// A quarter of the square is a quarter of a hemisphere: with r the distance from the zenith as
/// |u| + |v|, 1 - |z| is r^2, and the azimuth grows evenly along lines of constant r. The lower
/// hemisphere is folded over the diagonals, so that r is the distance from the nearest corner.
Direction fromSquare(DiscPoint p) {
    const double u = std::abs(p.u), v = std::abs(p.v), above = 1 - (u + v);
    const double r = 1 - std::abs(above);
    const double phi = (r > 0 ? (v - u) / r + 1 : 1) * (pi / 4);
    const double across = r * std::sqrt(2 - r * r);
    // pbrt's x is -x, and its y grows downwards.
    return {std::copysign(across * std::cos(phi), -p.u),
            std::copysign(across * std::sin(phi), -p.v), std::copysign(1 - r * r, above)};
}
DiscPoint toSquare(const Direction& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), squared = x * x + y * y;
    // sqrt(1 - |z|) without cancellation.
    const double r = std::sqrt(squared / (1 + std::abs(d.z)));
    double v = r * std::atan2(y, x) / (pi / 2), u = r - v;
    if (d.z < 0) {
        std::swap(u, v);
        u = 1 - u, v = 1 - v;
    }
    return {std::copysign(u, -d.x), std::copysign(v, -d.y)};
}

// --- cubes ----------------------------------------------------------------------------------

enum Face { right, left, top, bottom, front, back };

/// A face's place in a picture of faces; `turned` by 180 degrees.
struct Cell {
    std::size_t column, row;
    bool turned = false;
};
using Cells = std::array<Cell, 6>;  // by Face

const Cells& cellsOf(const PictureGeometry& g) {
    static constexpr Cells across = {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}};
    static constexpr Cells down = {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3, true}}};
    static constexpr Cells line = {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}};
    static constexpr Cells column = {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}};
    if (g.layout == PictureLayout::cross) return g.width > g.height ? across : down;
    return g.width > g.height ? line : column;
}

/// A point of a face, a to the right and b down, both in [-1, 1].
struct FacePoint {
    int face;
    double a, b;
};

/// On the cube of half-size 1, X to the right, Y up, Z forward.
std::array<double, 3> onCube(const FacePoint& p) {
    switch (p.face) {
        case right:
            return {1, -p.b, -p.a};
        case left:
            return {-1, -p.b, p.a};
        case top:
            return {p.a, 1, p.b};
        case bottom:
            return {p.a, -1, -p.b};
        case front:
            return {p.a, -p.b, 1};
        default:
            return {-p.a, -p.b, -1};
    }
}
FacePoint toCube(double x, double y, double z) {
    const double ax = std::abs(x), ay = std::abs(y), az = std::abs(z);
    if (ax >= ay && ax >= az) {
        return x > 0 ? FacePoint{right, -z / ax, -y / ax} : FacePoint{left, z / ax, -y / ax};
    }
    if (ay >= az)
        return y > 0 ? FacePoint{top, x / ay, z / ay} : FacePoint{bottom, x / ay, -z / ay};
    return z > 0 ? FacePoint{front, x / az, -y / az} : FacePoint{back, -x / az, -y / az};
}

/// The face at a cell, or -1.
int faceAt(const PictureGeometry& g, std::size_t cellColumn, std::size_t cellRow) {
    const Cells& cells = cellsOf(g);
    for (std::size_t face = 0; face < cells.size(); ++face) {
        if (cells[face].column == cellColumn && cells[face].row == cellRow) {
            return static_cast<int>(face);
        }
    }
    return -1;
}

Direction cubeDirection(const PictureGeometry& g, double column, double row) {
    const auto size = static_cast<double>(g.faceSize());
    const auto cellColumn = static_cast<std::size_t>(below(column, g.width) / size);
    const auto cellRow = static_cast<std::size_t>(below(row, g.height) / size);
    const int face = faceAt(g, cellColumn, cellRow);
    if (face < 0) return {};
    double a = 2 * (column / size - static_cast<double>(cellColumn)) - 1;
    double b = 2 * (row / size - static_cast<double>(cellRow)) - 1;
    if (cellsOf(g)[static_cast<std::size_t>(face)].turned) a = -a, b = -b;
    const auto [x, y, z] = onCube({face, a, b});
    const double length = std::sqrt(x * x + y * y + z * z);
    return {z / length, -x / length, y / length};
}

std::array<double, 2> cubePosition(const PictureGeometry& g, const Direction& d) {
    FacePoint p = toCube(-d.y, d.z, d.x);
    const Cell& cell = cellsOf(g)[static_cast<std::size_t>(p.face)];
    if (cell.turned) p.a = -p.a, p.b = -p.b;
    const std::size_t n = g.faceSize();
    const auto size = static_cast<double>(n);
    // A rim belongs to its own face, not to the next cell.
    return {static_cast<double>(cell.column) * size + below((p.a + 1) / 2 * size, n),
            static_cast<double>(cell.row) * size + below((p.b + 1) / 2 * size, n)};
}

/// The pixel of the next face: the middle of the pixel beyond the edge, seen from the middle of the
/// cube.
std::array<std::size_t, 2> cubeNeighbour(const PictureGeometry& g, std::size_t column,
                                         std::size_t row, int right, int down) {
    const std::size_t n = g.faceSize();
    const auto middle = [&](std::size_t at, int step) {
        return 2 * (static_cast<double>(at % n) + 0.5 + step) / static_cast<double>(n) - 1;
    };
    const int face = faceAt(g, column / n, row / n);
    double a = middle(column, right), b = middle(row, down);
    if (cellsOf(g)[static_cast<std::size_t>(face)].turned) a = -a, b = -b;
    const auto [x, y, z] = onCube({face, a, b});
    const auto place = cubePosition(g, {z, -x, y});
    return {static_cast<std::size_t>(place[0]), static_cast<std::size_t>(place[1])};
}

double cubeSolidAngle(const PictureGeometry& g, std::size_t column, std::size_t row) {
    const std::size_t n = g.faceSize();
    if (faceAt(g, column / n, row / n) < 0) return 0;
    const auto edge = [&](std::size_t k) {
        return 2 * static_cast<double>(k) / static_cast<double>(n) - 1;
    };
    const double a0 = edge(column % n), a1 = edge(column % n + 1);
    const double b0 = edge(row % n), b1 = edge(row % n + 1);
    // The solid angle of the rectangle from the middle of a face to (a, b).
    const auto corner = [](double a, double b) {
        return std::atan2(a * b, std::sqrt(a * a + b * b + 1));
    };
    return corner(a1, b1) - corner(a0, b1) - corner(a1, b0) + corner(a0, b0);
}

}  // namespace

Direction PictureGeometry::direction(double column, double row) const {
    const auto w = static_cast<double>(width), h = static_cast<double>(height);
    const DiscPoint p{2 * column / w - 1, 1 - 2 * row / h};
    switch (layout) {
        case PictureLayout::latlong:
            return directionFromAngles(pi * row / h, pi - 2 * pi * column / w);
        case PictureLayout::angular:
            return fromAngular(p);
        case PictureLayout::mirrorBall:
            return fromMirrorBall(p);
        case PictureLayout::cross:
        case PictureLayout::faces:
            return cubeDirection(*this, column, row);
        case PictureLayout::dome:
            return fromDome(p);
        case PictureLayout::equalArea:
            return fromSquare(p);
    }
    return {};
}

std::array<double, 2> PictureGeometry::position(const Direction& d) const {
    const auto w = static_cast<double>(width), h = static_cast<double>(height);
    const auto onDisc = [&](DiscPoint p) -> std::array<double, 2> {
        return {below((p.u + 1) / 2 * w, width), below((1 - p.v) / 2 * h, height)};
    };
    switch (layout) {
        case PictureLayout::latlong:
            return {below((pi - azimuth(d)) / (2 * pi) * w, width),
                    below(polarAngle(d) / pi * h, height)};
        case PictureLayout::angular:
            return onDisc(toAngular(d));
        case PictureLayout::mirrorBall:
            return onDisc(toMirrorBall(d));
        case PictureLayout::cross:
        case PictureLayout::faces:
            return cubePosition(*this, d);
        case PictureLayout::dome:
            return onDisc(toDome(d));
        case PictureLayout::equalArea:
            return onDisc(toSquare(d));
    }
    return {};
}

bool PictureGeometry::covers(const Direction& d) const {
    return layout != PictureLayout::dome || d.z >= 0;
}

std::optional<std::array<std::size_t, 2>> PictureGeometry::neighbour(std::size_t column,
                                                                     std::size_t row, int right,
                                                                     int down) const {
    using Place = std::array<std::size_t, 2>;
    if (!(solidAngle(column, row) > 0)) return {};
    const std::size_t face = faceSize();
    // Steps from 0 and to the limit stay within, others go beyond.
    const auto beyond = [](std::size_t at, int step, std::size_t limit) {
        return step < 0 ? at == 0 : step > 0 && at + 1 == limit;
    };
    const auto moved = [](std::size_t at, int step) {
        return step < 0 ? at - 1 : at + static_cast<std::size_t>(step);
    };
    const bool aside = face > 0 ? beyond(column % face, right, face) : beyond(column, right, width);
    const bool apart = face > 0 ? beyond(row % face, down, face) : beyond(row, down, height);
    if (!aside && !apart) {
        const Place place{moved(column, right), moved(row, down)};
        if (!(solidAngle(place[0], place[1]) > 0)) return {};
        return place;
    }
    if (face > 0) return cubeNeighbour(*this, column, row, right, down);
    if (layout == PictureLayout::latlong)
        return Place{aside ? (right < 0 ? width - 1 : 0) : (column + width / 2) % width, row};
    // The square is folded along its rim.
    if (layout == PictureLayout::equalArea)
        return aside ? Place{column, height - 1 - row} : Place{width - 1 - column, row};
    return {};
}

double PictureGeometry::solidAngle(std::size_t column, std::size_t row) const {
    assert(column < width && row < height);
    if (layout == PictureLayout::latlong) {
        const double step = pi / static_cast<double>(height);
        return 2 * std::sin(step * (static_cast<double>(row) + 0.5)) * std::sin(step / 2) *
               (2 * pi / static_cast<double>(width));
    }
    if (faceSize() > 0) return cubeSolidAngle(*this, column, row);
    if (layout == PictureLayout::equalArea)
        return 4 * pi / (static_cast<double>(width) * static_cast<double>(height));
    return discSolidAngle(*this, column, row);
}

double PictureGeometry::density(double column, double row) const {
    const auto w = static_cast<double>(width), h = static_cast<double>(height);
    if (layout == PictureLayout::latlong) return std::sin(pi * row / h) * (pi / h) * (2 * pi / w);
    if (const std::size_t n = faceSize(); n > 0) {
        const auto size = static_cast<double>(n);
        const auto cellColumn = static_cast<std::size_t>(below(column, width) / size);
        const auto cellRow = static_cast<std::size_t>(below(row, height) / size);
        if (faceAt(*this, cellColumn, cellRow) < 0) return 0;
        const double a = 2 * (column / size - static_cast<double>(cellColumn)) - 1;
        const double b = 2 * (row / size - static_cast<double>(cellRow)) - 1;
        return std::pow(1 + a * a + b * b, -1.5) * 4 / (size * size);
    }
    if (layout == PictureLayout::equalArea) return 4 * pi / (w * h);
    const double u = 2 * column / w - 1, v = 1 - 2 * row / h;
    return std::hypot(u, v) < 1 ? discDensity(layout, u, v) * 4 / (w * h) : 0;
}

double PictureGeometry::pixelAngle() const {
    if (const std::size_t n = faceSize(); n > 0) return pi / 2 / static_cast<double>(n);
    if (layout == PictureLayout::equalArea) return std::sqrt(4 * pi) / static_cast<double>(height);
    const bool half = layout == PictureLayout::latlong || layout == PictureLayout::dome;
    const double perDiameter = half ? pi : 2 * pi;
    return perDiameter / static_cast<double>(height);
}

std::size_t PictureGeometry::faceSize() const {
    if (layout == PictureLayout::cross) return width > height ? height / 3 : width / 3;
    if (layout == PictureLayout::faces) return std::min(width, height);
    return 0;
}

std::span<const LayoutName> layoutNames() {
    return names;
}

bool layoutFits(PictureLayout layout, std::size_t width, std::size_t height) {
    const auto ratio = [&](std::size_t w, std::size_t h) {
        return width % w == 0 && width / w * h == height;
    };
    switch (layout) {
        case PictureLayout::latlong:
            return ratio(2, 1);
        case PictureLayout::angular:
        case PictureLayout::mirrorBall:
        case PictureLayout::equalArea:
            return ratio(1, 1);
        case PictureLayout::dome:
            return ratio(1, 1) || ratio(4, 1);
        case PictureLayout::cross:
            return ratio(4, 3) || ratio(3, 4);
        case PictureLayout::faces:
            return ratio(6, 1) || ratio(1, 6);
    }
    return false;
}

std::optional<PictureLayout> layoutOfSize(std::size_t width, std::size_t height) {
    std::optional<PictureLayout> found;
    for (const LayoutName& row : names) {
        if (!layoutFits(row.layout, width, height)) continue;
        if (found) return {};
        found = row.layout;
    }
    return found;
}

std::string_view layoutSizes(PictureLayout layout) {
    switch (layout) {
        case PictureLayout::latlong:
            return "twice as wide as high";
        case PictureLayout::angular:
        case PictureLayout::mirrorBall:
        case PictureLayout::equalArea:
            return "as wide as high";
        case PictureLayout::dome:
            return "1 : 1 or 4 : 1";
        case PictureLayout::cross:
            return "4 : 3 or 3 : 4";
        case PictureLayout::faces:
            return "6 : 1 or 1 : 6";
    }
    return {};
}

std::string_view layoutName(PictureLayout layout) {
    return std::ranges::find(names, layout, &LayoutName::layout)->name;
}

}  // namespace hshfit::inline light
