#include <hshfit/accuracy/isotropy.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace hshfit::inline accuracy {

double azimuthVariation(const Brdf& brdf) {
    constexpr int azimuths = 24;
    const Direction normal{0, 0, 1};
    double largest = 0;
    for (const double theta : {15.0, 30.0, 45.0, 60.0, 75.0}) {
        std::array<double, azimuths> totals;
        for (int k = 0; k < azimuths; ++k) {
            const Direction wo = directionFromAngles(radians(theta), 2 * pi * k / azimuths);
            const std::vector<double> f = evaluate(brdf, normal, wo);
            totals[static_cast<std::size_t>(k)] = std::accumulate(f.begin(), f.end(), 0.0);
        }
        const double mean = std::accumulate(totals.begin(), totals.end(), 0.0) / azimuths;
        double variance = 0;
        for (const double total : totals) variance += (total - mean) * (total - mean) / azimuths;
        if (mean > 0 && std::isfinite(variance))
            largest = std::max(largest, std::sqrt(variance) / mean);
    }
    return largest;
}

}  // namespace hshfit::inline accuracy
