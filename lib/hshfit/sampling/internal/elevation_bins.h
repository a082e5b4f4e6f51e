#pragma once

#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hshfit::inline sampling {

/// Bins of outgoing elevation, narrower towards the horizon: with s = 1 - sqrt(1 - theta / 90
/// degrees), bin k of n has k / n <= s < (k + 1) / n. With n = 32 the first ends at 5.5 degrees and
/// the last begins 0.09 degrees above the horizon.
inline std::size_t elevationBin(const Direction& wo, std::size_t bins) {
    const double s = 1 - std::sqrt(std::asin(std::clamp(wo.z, 0.0, 1.0)) * 2 / pi);
    return std::min(bins - 1, static_cast<std::size_t>(s * static_cast<double>(bins)));
}

/// The direction at s and this azimuth; 0 <= s < 1.
inline Direction directionOfBin(double s, double phi) {
    const double above = pi / 2 * (1 - s) * (1 - s), across = std::cos(above);
    return {across * std::cos(phi), across * std::sin(phi), std::sin(above)};
}

}  // namespace hshfit::inline sampling
