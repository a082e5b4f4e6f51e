#include <hshfit/meshes/internal/polygon.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline meshes {
namespace {

struct Point {
    double x, y;
};

/// Twice the signed area.
double turn(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The corners in the plane onto which the polygon has the largest area, counterclockwise.
std::vector<Point> flattened(std::span<const MeshVector> corners) {
    double normal[3] = {};
    const auto at = [&](std::size_t k, std::size_t i) {
        return double{corners[k][i]} - double{corners[0][i]};
    };
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const std::size_t next = (k + 1) % corners.size();
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t p = (i + 1) % 3, q = (i + 2) % 3;
            normal[i] += (at(k, p) - at(next, p)) * (at(k, q) + at(next, q));
        }
    }
    const auto dropped = static_cast<std::size_t>(
        std::max_element(normal, normal + 3,
                         [](double a, double b) { return std::abs(a) < std::abs(b); }) -
        normal);
    std::size_t p = (dropped + 1) % 3, q = (dropped + 2) % 3;
    if (normal[dropped] < 0) std::swap(p, q);
    std::vector<Point> points;
    for (std::size_t k = 0; k < corners.size(); ++k) points.push_back({at(k, p), at(k, q)});
    return points;
}

class Cutter {
public:
    Cutter(std::span<const MeshVector> corners,
           std::vector<std::array<std::uint32_t, 3>>& triangles)
        : corners_(corners), points_(flattened(corners)), triangles_(triangles) {
        double size = 0;
        for (const Point& point : points_)
            size = std::max({size, std::abs(point.x), std::abs(point.y)});
        rounding_ = 1e-7 * size * size;  // of positions in single precision
    }

    bool run() {
        if (points_.size() == 4) return quadrilateral(), true;
        if (isFan()) return fan(), true;
        if (points_.size() > mostEars) return false;
        cutEars();
        return true;
    }

private:
    void add(std::size_t a, std::size_t b, std::size_t c) {
        triangles_.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                              static_cast<std::uint32_t>(c)});
    }
    double area(std::size_t a, std::size_t b, std::size_t c) const {
        return turn(points_[a], points_[b], points_[c]);
    }
    double length(std::size_t a, std::size_t b) const {
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i)
            sum += std::pow(double{corners_[a][i]} - double{corners_[b][i]}, 2);
        return sum;
    }

    void quadrilateral() {
        const double first = std::min(area(0, 1, 2), area(0, 2, 3));
        const double second = std::min(area(0, 1, 3), area(1, 2, 3));
        const bool inside = first >= -rounding_, other = second >= -rounding_;
        const bool along = inside == other ? length(0, 2) <= length(1, 3) : inside;
        add(0, 1, along ? 2 : 3);
        add(along ? 0 : 1, 2, 3);
    }

    bool isFan() const {
        for (std::size_t k = 1; k + 1 < points_.size(); ++k)
            if (area(0, k, k + 1) < -rounding_) return false;
        return true;
    }
    void fan() {
        for (std::size_t k = 1; k + 1 < points_.size(); ++k) add(0, k, k + 1);
    }

    /// Whether no other corner that is left lies in the triangle of corner `at` and its neighbours.
    bool isEar(const std::vector<std::size_t>& left, std::size_t at) const {
        const std::size_t count = left.size();
        const std::size_t a = left[(at + count - 1) % count], b = left[at],
                          c = left[(at + 1) % count];
        if (!(area(a, b, c) > rounding_)) return false;
        for (const std::size_t p : left) {
            if (p == a || p == b || p == c) continue;
            const bool same = std::ranges::any_of(std::array{a, b, c}, [&](std::size_t other) {
                return points_[p].x == points_[other].x && points_[p].y == points_[other].y;
            });
            if (!same && area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0)
                return false;
        }
        return true;
    }

    void cutEars() {
        std::vector<std::size_t> left(points_.size());
        for (std::size_t k = 0; k < left.size(); ++k) left[k] = k;
        std::size_t at = 0, tried = 0;
        while (left.size() > 3) {
            const std::size_t count = left.size();
            at %= count;
            // A polygon that crosses itself may have no ear: a corner without one is cut then.
            if (!isEar(left, at) && tried < count) {
                ++at, ++tried;
                continue;
            }
            add(left[(at + count - 1) % count], left[at], left[(at + 1) % count]);
            left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
            tried = 0;
        }
        add(left[0], left[1], left[2]);
    }

    std::span<const MeshVector> corners_;
    std::vector<Point> points_;
    std::vector<std::array<std::uint32_t, 3>>& triangles_;
    double rounding_ = 0;
};

}  // namespace

bool cutPolygon(std::span<const MeshVector> corners,
                std::vector<std::array<std::uint32_t, 3>>& triangles) {
    if (corners.size() == 3) {
        triangles.push_back({0, 1, 2});
        return true;
    }
    return Cutter(corners, triangles).run();
}

}  // namespace hshfit::inline meshes
