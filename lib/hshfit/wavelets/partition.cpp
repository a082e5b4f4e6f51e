#include <hshfit/wavelets/partition.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::wavelets {
namespace {

/// The volume spanned by d and an edge: its sign says on which side of the edge d is.
double side(const Direction& d, const Direction& a, const Direction& b) {
    return d.x * (a.y * b.z - a.z * b.y) + d.y * (a.z * b.x - a.x * b.z) +
           d.z * (a.x * b.y - a.y * b.x);
}

std::size_t rootOf(const Direction& d, bool sphere) {
    const std::size_t quadrant = d.y >= 0 ? (d.x >= 0 ? 0 : 1) : (d.x < 0 ? 2 : 3);
    return sphere && d.z < 0 ? 4 + quadrant : quadrant;
}

}  // namespace

Partition::Partition(Domain domain, int levels) : domain_(domain) {
    if (levels < 0 || levels > mostLevels) {
        throw UsageError(
            fmt::format("{} levels of a partition are outside 0 .. {}", levels, mostLevels));
    }
    const auto all = octants();
    const std::size_t roots = domain == Domain::sphere ? 8 : 4;
    triangles_.emplace_back(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(roots));
    for (int j = 0; j < levels; ++j) {
        std::vector<Triangle> next;
        next.reserve(4 * triangles_.back().size());
        for (const Triangle& triangle : triangles_.back()) {
            const auto children = subdivided(triangle);
            next.insert(next.end(), children.begin(), children.end());
        }
        triangles_.push_back(std::move(next));
    }
}

void Partition::locate(const Direction& d, int levels, unsigned char* path) const {
    const bool sphere = domain_ == Domain::sphere;
    const Direction at{d.x, d.y, sphere ? d.z : std::abs(d.z)};
    std::size_t k = rootOf(at, sphere);
    path[0] = static_cast<unsigned char>(k);
    for (int j = 1; j <= levels; ++j) {
        // The corners of the central child are on the edges 1, 2 and 0.
        const auto& [on1, on2, on0] = level(j)[4 * k].corners;
        unsigned char child = 0;
        if (side(at, on2, on0) < 0) {
            child = 1;
        } else if (side(at, on0, on1) < 0) {
            child = 2;
        } else if (side(at, on1, on2) < 0) {
            child = 3;
        }
        path[j] = child;
        k = 4 * k + child;
    }
}

Direction centreOf(const Triangle& triangle) {
    Direction sum{0, 0, 0};
    for (const Direction& corner : triangle.corners) {
        sum = {sum.x + corner.x, sum.y + corner.y, sum.z + corner.z};
    }
    const double length = std::sqrt(dot(sum, sum));
    return {sum.x / length, sum.y / length, sum.z / length};
}

}  // namespace hshfit::wavelets
