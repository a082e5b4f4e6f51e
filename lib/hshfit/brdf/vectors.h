#pragma once

#include <hshfit/brdf/directions.h>

#include <cmath>

namespace hshfit::inline brdf {

/// Componentwise sums, differences and multiples; the results need not have length 1.
inline Direction operator+(const Direction& a, const Direction& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Direction operator-(const Direction& a, const Direction& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Direction operator-(const Direction& d) {
    return {-d.x, -d.y, -d.z};
}
inline Direction operator*(double factor, const Direction& d) {
    return {factor * d.x, factor * d.y, factor * d.z};
}

/// a x b, of length sin(angle between them).
inline Direction cross(const Direction& a, const Direction& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// d / |d|; not finite for a vector that is 0.
inline Direction normalised(const Direction& d) {
    const double length = std::sqrt(dot(d, d));
    return {d.x / length, d.y / length, d.z / length};
}

/// The angle between two unit vectors, in [0, pi] radians: 2 atan2(|a - b|, |a + b|) (Kahan 2006,
/// "How Futile are Mindless Assessments of Roundoff in Floating-Point Computation?", section 12).
/// It is accurate at both ends, where the arc cosine of dot(a, b) loses half of the digits.
inline double angleBetween(const Direction& a, const Direction& b) {
    const Direction difference = a - b, sum = a + b;
    return 2 * std::atan2(std::sqrt(dot(difference, difference)), std::sqrt(dot(sum, sum)));
}

}  // namespace hshfit::inline brdf
