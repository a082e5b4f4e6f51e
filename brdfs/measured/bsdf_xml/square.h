#pragma once

#include <brdfs/measured/angles.h>
#include <hshfit/brdf/directions.h>
#include <hshfit/brdf/steps.h>

#include <cmath>

namespace hshfit::brdfs {

/// The disc onto the square by the concentric map of Shirley & Chiu, "A Low Distortion Map Between
/// Disk and Square", J. Graphics Tools 2(3), 1997. It keeps the ratio of areas, so that with (x, y)
/// of a unit vector equal areas of the square are equal projected solid angles:
///     cos(theta) d omega = dx dy = pi du dv.
/// Mirroring at an axis of the disc mirrors the square at its middle. The inverse is
/// `directionFromSquare`.
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

}  // namespace hshfit::brdfs
