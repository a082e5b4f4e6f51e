#pragma once

#include <hshfit/directions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

/// The half vector wi + wo, not normalised and never formed from angles: its x and y, the
/// differences that carry a sharp lobe, keep all their digits. If it is very short (both directions
/// at the horizon, opposite) it is divided by its largest component, so that no square underflows.
struct HalfVector {
    double x, y, z;    ///< z at least `leastZ`
    double scale = 1;  ///< wi + wo = scale (x, y, z)

    /// Slopes are cut at 2e70, where every lobe has long vanished, so that powers of them that
    /// meet exp(-slope^2) stay finite.
    static constexpr double leastZ = 1e-70;

    HalfVector(const Direction& wo, double wiX, double wiY, double wiZ) {
        x = wiX + wo.x, y = wiY + wo.y, z = wiZ + wo.z;
        const double largest = std::max({std::abs(x), std::abs(y), z});
        if (largest < 1e-30) scale = largest, x /= scale, y /= scale, z /= scale;
        z = std::max(z, leastZ);
    }

    double squaredLength() const { return x * x + y * y + z * z; }
    double slopeX() const { return x / z; }
    double slopeY() const { return y / z; }
    /// tan^2 of the angle to the normal.
    double squaredSlope() const { return (x * x + y * y) / (z * z); }
    /// Cosine of the angle to either direction: half the length of wi + wo. At most 1.
    double dotOutgoing() const { return std::min(1.0, 0.5 * scale * std::sqrt(squaredLength())); }
};

}  // namespace hshfit::brdfs
