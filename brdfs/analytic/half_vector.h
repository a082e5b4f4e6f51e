#pragma once

#include <hshfit/directions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

/// The half vector wi + wo, divided by its largest component so that nothing underflows with both
/// directions at the horizon, and never formed from angles: its x and y, the differences that
/// carry a sharp lobe, keep all their digits.
struct HalfVector {
    double x, y, z;  ///< largest magnitude 1; z at least `leastZ`
    double scale;    ///< wi + wo = scale (x, y, z)

    /// Slopes are cut at 1e70, where every lobe has long vanished, so that powers of them that
    /// meet exp(-slope^2) stay finite.
    static constexpr double leastZ = 1e-70;

    HalfVector(const Direction& wo, double wiX, double wiY, double wiZ) {
        x = wiX + wo.x, y = wiY + wo.y, z = wiZ + wo.z;
        scale = std::max({std::abs(x), std::abs(y), z});
        x /= scale, y /= scale, z = std::max(z / scale, leastZ);
    }

    double squaredLength() const { return x * x + y * y + z * z; }
    double slopeX() const { return x / z; }
    double slopeY() const { return y / z; }
    /// tan^2 of the angle to the normal.
    double squaredSlope() const { return (x * x + y * y) / (z * z); }
    /// Cosine of the angle to either direction: half the length of wi + wo. At most 1.
    double dotOutgoing() const { return std::min(1.0, 0.5 * scale * std::sqrt(squaredLength())); }
};

/// Schlick's (1 - cos)^5, the weight of 1 - F0.
inline double schlickWeight(double cosine) {
    const double rest = 1 - cosine;
    const double squared = rest * rest;
    return squared * squared * rest;
}

}  // namespace hshfit::brdfs
