#include <brdfs/analytic/kink_curves.h>

#include <cmath>

namespace hshfit::brdfs {

std::vector<KinkCurve> vGrooveKinks(const Direction& wo) {
    return {{.x = wo.x, .y = wo.y, .constant = 1 - 2 * wo.z * wo.z, .linear = -wo.z, .low = wo.z},
            {.x = wo.x, .y = wo.y, .constant = 1, .linear = -wo.z, .square = -2, .high = wo.z}};
}

std::vector<KinkCurve> clampedPowerKinks(const Direction& axis, double exponent) {
    // From this exponent on the term has as many derivatives as any rule makes use of.
    constexpr double smooth = 16;
    if (exponent >= smooth) return {};
    return {circleAbout(axis, 0, exponent == std::floor(exponent))};
}

KinkCurve halfAngleKink(const Direction& wo, double cosine, bool smoothSides) {
    return circleAbout(wo, 2 * cosine * cosine - 1, smoothSides);
}

std::vector<KinkCurve> totalReflectionKinks(const Direction& wo, std::span<const double> indices) {
    std::vector<KinkCurve> curves;
    for (const double index : indices)
        if (index > 0 && index < 1)
            curves.push_back(halfAngleKink(wo, std::sqrt((1 - index) * (1 + index)), false));
    return curves;
}

}  // namespace hshfit::brdfs
