#pragma once

#include <cstddef>

namespace hshfit::inline brdf {

/// A unit vector in the local frame: right-handed, +z the surface normal, +x the tangent.
/// Incoming and outgoing directions both point away from the surface.
struct Direction {
    double x = 0, y = 0, z = 1;
};

/// Many directions as three arrays of `count` values, for batch evaluation.
struct DirectionBatch {
    const double* x = nullptr;
    const double* y = nullptr;
    const double* z = nullptr;
    std::size_t count = 0;
};

/// (sin theta cos phi, sin theta sin phi, cos theta), radians, any real angles.
Direction directionFromAngles(double theta, double phi);

/// Polar angle in [0, pi], from atan2(sin, cos): accurate at the pole and at grazing angles.
double polarAngle(const Direction& d);

/// Azimuth in (-pi, pi]; 0 at the pole.
double azimuth(const Direction& d);

/// 1 - z without cancellation near the pole: (x^2 + y^2) / (1 + z) for z > 0.
double oneMinusZ(const Direction& d);

/// A polar position as both mu = cos(theta) and 1 - mu, so that neither end loses digits.
/// Use `elevationOf`, which takes 1 - mu from x and y near the pole.
template <class Real>
struct Elevation {
    Real mu;
    Real oneMinusMu;
};

/// The elevation of a unit vector, 1 - mu from `oneMinusZ`.
Elevation<double> elevationOf(const Direction& d);

/// The inner product; of unit vectors, the cosine of the angle between them.
inline double dot(const Direction& a, const Direction& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// `d` turned about +z by `angle` radians.
Direction rotateAboutZ(const Direction& d, double angle);

/// The mirror direction of `d` about the normal: (-x, -y, z).
inline Direction mirrored(const Direction& d) {
    return {-d.x, -d.y, d.z};
}

/// An incoming and an outgoing direction.
struct DirectionPair {
    Direction wi, wo;
};

/// The pair with the given half and difference angles (Rusinkiewicz 1998), radians: h is at
/// (thetaHalf, phiHalf), and (thetaDifference, phiDifference) is wi in the frame in which h is the
/// pole and the normal lies at azimuth pi. Either may lie below the horizon.
DirectionPair fromHalfDifference(double thetaHalf, double phiHalf, double thetaDifference,
                                 double phiDifference);

/// Half the circumference of the unit circle, rounded to double.
constexpr double pi = 3.14159265358979323846264338327950288;

/// Degrees to radians, and back.
inline double radians(double degrees) {
    return degrees * (pi / 180);
}
inline double degrees(double radians) {
    return radians * (180 / pi);
}

}  // namespace hshfit::inline brdf
