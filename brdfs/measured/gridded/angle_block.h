#pragma once

#include <brdfs/measured/angles.h>
#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hshfit::brdfs {

/// Polar angles in [0, pi/2] and azimuths in [0, 2 pi) of a block of directions, accurate to 1e-11.
/// Below the horizon theta is pi/2; at the normal phi is 0.
struct AngleBlock {
    static constexpr std::size_t size = 64;
    double theta[size], phi[size];

    // One short loop per angle, over arrays that cannot overlap: the compiler vectorises these.
    void set(const DirectionBatch& d, std::size_t begin, std::size_t count) {
        double x[size], y[size], z[size];
        std::copy_n(d.x + begin, count, x);
        std::copy_n(d.y + begin, count, y);
        std::copy_n(d.z + begin, count, z);
        for (std::size_t k = 0; k < count; ++k) {
            theta[k] = quadrantAngle(std::sqrt(x[k] * x[k] + y[k] * y[k]), std::max(z[k], 0.0));
        }
        for (std::size_t k = 0; k < count; ++k) {
            const double angle = rayAngle(y[k], x[k]);
            const double turned = angle < 0 ? angle + 2 * pi : angle;
            phi[k] = turned < 2 * pi ? turned : 0;
        }
    }
    void set(const Direction& d) { set({&d.x, &d.y, &d.z, 1}, 0, 1); }
};

/// Two neighbouring nodes of an axis, and the fraction of the way from the first to the second.
struct Between {
    std::size_t low = 0, high = 0;
    double t = 0;
};

/// On a circle of `count` nodes; `index` in [0, count].
inline Between aroundCircle(double index, std::size_t count) {
    auto low = static_cast<std::size_t>(index);
    const double t = index - static_cast<double>(low);
    if (low >= count) low -= count;
    return {low, low + 1 == count ? 0 : low + 1, t};
}

/// On a line of `count` nodes (at least 1), constant beyond its ends.
inline Between alongLine(double index, std::size_t count) {
    const double last = static_cast<double>(count - 1);
    const double inside = std::min(std::max(index, 0.0), last);
    const auto low = static_cast<std::size_t>(inside);
    return {low, std::min(low + 1, count - 1), inside - static_cast<double>(low)};
}

}  // namespace hshfit::brdfs
