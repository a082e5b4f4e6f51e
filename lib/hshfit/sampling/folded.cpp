#include <hshfit/sampling/internal/folded.h>

#include <cmath>
#include <limits>

namespace hshfit::inline sampling {

Direction foldedUp(const Direction& wi) {
    const double length = std::sqrt(dot(wi, wi));
    // On the horizon itself f is 0; the least height keeps the density defined.
    const double z = std::max(std::abs(wi.z) / length, std::numeric_limits<double>::min());
    return {wi.x / length, wi.y / length, z};
}

Sample FoldedSampler::sample(const Direction& wo, const Uniforms& u) const {
    if (!(wo.z > 0)) return {};
    const Direction wi = foldedUp(draw(wo, u));
    return {wi, pdf(wo, wi)};
}

double FoldedSampler::pdf(const Direction& wo, const Direction& wi) const {
    if (!aboveHorizon(wo, wi)) return 0;
    return density(wo, wi) + density(wo, {wi.x, wi.y, -wi.z});
}

}  // namespace hshfit::inline sampling
