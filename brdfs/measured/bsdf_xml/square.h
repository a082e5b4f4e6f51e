#pragma once

#include <brdfs/measured/angles.h>
#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

/// A point of the unit square.
struct SquarePoint {
    double u = 0, v = 0;
};

/// The disc onto the square by the concentric map of Shirley & Chiu, "A Low Distortion Map Between
/// Disk and Square", J. Graphics Tools 2(3), 1997. It keeps the ratio of areas, so that with (x, y)
/// of a unit vector equal areas of the square are equal projected solid angles:
///     cos(theta) d omega = dx dy = pi du dv.
/// Mirroring at an axis of the disc mirrors the square at its middle.
inline SquarePoint squareFromDisc(double x, double y) {
    const double r = std::sqrt(x * x + y * y);
    const bool flat = std::fabs(y) <= std::fabs(x);
    // The angle from the nearest half axis, in eighths of a turn.
    const double angle =
        4 / pi *
        quadrantAngle(flat ? std::fabs(y) : std::fabs(x), flat ? std::fabs(x) : std::fabs(y));
    const double a = std::copysign(flat ? r : r * angle, x);
    const double b = std::copysign(flat ? r * angle : r, y);
    return {0.5 * (a + 1), 0.5 * (b + 1)};
}

/// The inverse: the direction above the horizon for a point of the square.
inline Direction directionFromSquare(const SquarePoint& p) {
    const double a = 2 * p.u - 1, b = 2 * p.v - 1;
    if (a == 0 && b == 0) return {0, 0, 1};
    const bool flat = std::fabs(b) <= std::fabs(a);
    const double r = flat ? a : b;
    const double angle = pi / 4 * (flat ? b / a : a / b);
    const double along = r * std::cos(angle), across = r * std::sin(angle);
    // 1 - r^2 without cancellation.
    return {flat ? along : across, flat ? across : along,
            std::sqrt(std::max((1 - r) * (1 + r), 0.0))};
}

}  // namespace hshfit::brdfs
