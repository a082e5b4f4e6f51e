#pragma once

#include <hshfit/brdf/vectors.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline normal_filtering {

/// A point of the stereographic plane: u = 2 (n.x, n.y) / (1 + n.z) of a unit vector n. The plane
/// keeps angles: |a - b|^2 = |u_a - u_b|^2 / ((1 + |u_a|^2 / 4)(1 + |u_b|^2 / 4)).
using PlanePoint = std::array<double, 2>;

/// Within 5 degrees of -z, as if 5 degrees off.
inline PlanePoint toPlane(const Direction& n) {
    const double factor = 2 / std::max(1 + n.z, 0.004);
    return {n.x * factor, n.y * factor};
}
inline Direction fromPlane(const PlanePoint& u) {
    const double square = u[0] * u[0] + u[1] * u[1], factor = 4 / (4 + square);
    return {u[0] * factor, u[1] * factor, (4 - square) / (4 + square)};
}

/// The tangent at n that the direction (cos, sin) of the plane has there, of length 1.
inline Direction fromPlaneDirection(const PlanePoint& u, const PlanePoint& along) {
    const double sum = 4 + u[0] * u[0] + u[1] * u[1];
    const double product = u[0] * along[0] + u[1] * along[1];
    return {along[0] - 2 * u[0] * product / sum, along[1] - 2 * u[1] * product / sum,
            -4 * product / sum};
}
/// The inverse: the direction in the plane of a tangent at n.
inline PlanePoint toPlaneDirection(const Direction& n, const Direction& tangent) {
    const double sum = std::max(1 + n.z, 0.004);
    const double x = tangent.x - n.x * tangent.z / sum, y = tangent.y - n.y * tangent.z / sum;
    const double length = std::hypot(x, y);
    return length > 0 ? PlanePoint{x / length, y / length} : PlanePoint{1, 0};
}

/// A right-handed frame: z the normal, x the part of the tangent that is perpendicular to it (any
/// perpendicular vector where there is none).
struct SurfaceFrame {
    Direction x, y, z;

    SurfaceFrame(const Direction& normal, const Direction& tangent) : z(normalised(normal)) {
        x = tangent - dot(tangent, z) * z;
        if (!(dot(x, x) > 1e-24))
            x = std::abs(z.x) < 0.9 ? Direction{1 - z.x * z.x, -z.x * z.y, -z.x * z.z}
                                    : Direction{-z.y * z.x, 1 - z.y * z.y, -z.y * z.z};
        x = normalised(x);
        y = cross(z, x);
    }
    Direction toLocal(const Direction& d) const { return {dot(d, x), dot(d, y), dot(d, z)}; }
};

}  // namespace hshfit::inline normal_filtering
