#include <hshfit/irradiance/geomerics.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline irradiance {

Rgb geomericsIrradiance(const NineRgb& radiance, const Direction& normal) {
    const double zero = std::sqrt(1 / (4 * pi)), one = 2.0 / 3 * std::sqrt(3 / (4 * pi));
    Rgb result{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double mean = zero * radiance[0][c];
        if (mean <= 0) continue;
        const Direction vector{one * radiance[3][c], one * radiance[1][c], one * radiance[2][c]};
        const double length = std::hypot(vector.x, vector.y, vector.z);
        const double share = std::min(length / (2 * mean), 1.0);
        const double along = length > 0 ? dot(vector, normal) / length : 0;
        const double q = std::clamp((1 + along) / 2, 0.0, 1.0);
        const double p = 1 + 2 * share, a = (1 - share) / (1 + share);
        result[c] = pi * mean * (a + (1 - a) * (p + 1) * std::pow(q, p));
    }
    return result;
}

}  // namespace hshfit::inline irradiance
