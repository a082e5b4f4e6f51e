#include <hshfit/gpu/highlight.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hshfit::gpu {
namespace {

constexpr double least = 0.02, most = 1;
constexpr int steps = 240;
constexpr double lastTheta = 60;  ///< degrees

/// f at a half angle, summed over channels; negative values, which some fits have, are 0.
double valueAt(const Brdf& brdf, double thetaHalf) {
    const DirectionPair pair = fromHalfDifference(thetaHalf, 0, radians(20), pi / 2);
    double sum = 0;
    for (const double f : evaluate(brdf, pair.wi, pair.wo))
        sum += std::isfinite(f) ? std::max(f, 0.0) : 0;
    return sum;
}

}  // namespace

double highlightRoughness(const Brdf& brdf) {
    double narrowest = most;
    const std::vector<Lobe> lobes = brdf.lobes(directionFromAngles(pi / 4, 0));
    for (const Lobe& lobe : lobes) {
        // The width of a lobe about an axis is twice that in half angles.
        const double half = lobe.about == Lobe::About::halfway ? 1 : 0.5;
        narrowest = std::min(narrowest, half * std::max(lobe.width, lobe.spread));
    }
    if (!lobes.empty()) return std::clamp(narrowest, least, most);
    const double base = valueAt(brdf, radians(lastTheta)), peak = valueAt(brdf, 0) - base;
    if (!(peak > 0.1 * base)) return most;
    for (int i = 1; i < steps; ++i) {
        const double theta = radians(lastTheta) * i / steps;
        if (valueAt(brdf, theta) - base < 0.25 * peak)
            return std::clamp(std::tan(theta), least, most);
    }
    return most;
}

}  // namespace hshfit::gpu
