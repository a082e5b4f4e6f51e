#include <brdfs/fit/gaussian_mixture.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// The two elevations about theta, and the weight of the second.
struct Neighbours {
    std::size_t first, second;
    double weight;
};

Neighbours neighbours(const std::vector<GaussianElevation>& elevations, double theta) {
    const auto after = std::ranges::upper_bound(elevations, theta, {}, &GaussianElevation::theta);
    const auto second = static_cast<std::size_t>(after - elevations.begin());
    if (second == 0) return {0, 0, 0};
    if (second == elevations.size()) return {second - 1, second - 1, 0};
    const double from = elevations[second - 1].theta, to = elevations[second].theta;
    return {second - 1, second, (theta - from) / (to - from)};
}

/// The frame of a lobe's axis: w.p and w.x.
struct InPlane {
    double along, aside;
};
InPlane inPlane(const Direction& w, double angle) {
    const double s = std::sin(angle), c = std::cos(angle);
    return {w.x * s + w.z * c, w.x * c - w.z * s};
}

}  // namespace

GaussianValue evaluateLobe(GaussianKind kind, const GaussianLobe& lobe, double theta,
                           const Direction& wi) {
    const double angle = theta + lobe.tilt;
    const InPlane w = inPlane(wi, angle);
    if (kind == GaussianKind::spherical) {
        // 1 - w.p from the distance to p, without cancellation.
        const double dx = wi.x - std::sin(angle), dz = wi.z - std::cos(angle);
        const double versine = (dx * dx + wi.y * wi.y + dz * dz) / 2;
        const double value = std::exp(-lobe.sharpness * versine);
        return {value, value * lobe.sharpness * w.aside, -value * lobe.sharpness * versine, 0};
    }
    if (w.along <= 0) return {};
    const double inPlaneTerm = lobe.sharpness * w.aside * w.aside;
    const double acrossTerm = lobe.across * wi.y * wi.y;
    const double bell = std::exp(-inPlaneTerm - acrossTerm);
    return {w.along * bell, bell * w.aside * (1 + 2 * lobe.sharpness * w.along * w.along),
            -w.along * bell * inPlaneTerm, -w.along * bell * acrossTerm};
}

const Laws& GaussianMixture::laws() const {
    static constexpr Laws laws{.nonNegative = true, .isotropic = true, .mirrorSymmetric = true};
    return laws;
}

void GaussianMixture::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = content_.channels.count();
    std::fill(out, out + channels * wi.count, 0.0);
    if (!(wo.z > 0)) return;
    const double theta = polarAngle(wo), turn = pi - azimuth(wo);
    const double c = std::cos(turn), s = std::sin(turn);
    const Neighbours near = neighbours(content_.elevations, theta);
    const auto add = [&](const GaussianElevation& elevation, double weight) {
        if (weight == 0) return;
        for (const GaussianLobe& lobe : elevation.lobes)
            for (std::size_t k = 0; k < wi.count; ++k) {
                if (!(wi.z[k] > 0)) continue;
                const Direction w{c * wi.x[k] - s * wi.y[k], s * wi.x[k] + c * wi.y[k], wi.z[k]};
                const double value = weight * evaluateLobe(content_.kind, lobe, theta, w).value;
                for (std::size_t channel = 0; channel < channels; ++channel)
                    out[channel * wi.count + k] += lobe.amplitude[channel] * value;
            }
    };
    add(content_.elevations[near.first], 1 - near.weight);
    add(content_.elevations[near.second], near.weight);
}

std::vector<Lobe> GaussianMixture::lobes(const Direction& wo) const {
    std::vector<Lobe> hints;
    const double theta = polarAngle(wo), phi = azimuth(wo) + pi;
    const Neighbours near = neighbours(content_.elevations, theta);
    for (const std::size_t index : {near.first, near.second}) {
        for (const GaussianLobe& lobe : content_.elevations[index].lobes) {
            const bool spherical = content_.kind == GaussianKind::spherical;
            const double sharpness =
                spherical ? lobe.sharpness : 2 * std::max(lobe.sharpness, lobe.across);
            // 2.5 standard deviations: see Lobe::width.
            hints.push_back({Lobe::About::axis, std::min(1.0, 2.5 / std::sqrt(sharpness + 1)),
                             directionFromAngles(theta + lobe.tilt, phi)});
        }
        if (near.first == near.second) break;
    }
    return hints;
}

std::vector<Fact> GaussianMixture::facts() const {
    const auto& elevations = content_.elevations;
    return {{"kind", std::string(content_.kind == GaussianKind::spherical ? "sg" : "asg")},
            {"elevations", static_cast<std::int64_t>(elevations.size())},
            {"lobes", static_cast<std::int64_t>(elevations.front().lobes.size())},
            {"fitted_to", content_.source}};
}

}  // namespace hshfit::brdfs
