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

/// A lobe for one wo: sine and cosine of its axis' angle are common to all wi.
class PlacedLobe {
public:
    PlacedLobe(GaussianKind kind, const GaussianLobe& lobe, double theta)
        : kind_(kind),
          lobe_(lobe),
          sine_(std::sin(theta + lobe.tilt)),
          cosine_(std::cos(theta + lobe.tilt)) {}

    double along(const Direction& w) const { return w.x * sine_ + w.z * cosine_; }
    double aside(const Direction& w) const { return w.x * cosine_ - w.z * sine_; }
    /// 1 - w.p from the distance to p, without cancellation.
    double versine(const Direction& w) const {
        const double dx = w.x - sine_, dz = w.z - cosine_;
        return (dx * dx + w.y * w.y + dz * dz) / 2;
    }

    double value(const Direction& w) const {
        if (kind_ == GaussianKind::spherical) return bell(lobe_.sharpness * versine(w));
        const double height = along(w), side = aside(w);
        if (height <= 0) return 0;
        return height * bell(lobe_.sharpness * side * side + lobe_.across * w.y * w.y);
    }

private:
    /// exp(-x), which is 0 beyond the least double.
    static double bell(double x) { return x > 750 ? 0 : std::exp(-x); }

    GaussianKind kind_;
    const GaussianLobe& lobe_;
    double sine_, cosine_;
};

}  // namespace

GaussianValue evaluateLobe(GaussianKind kind, const GaussianLobe& lobe, double theta,
                           const Direction& wi) {
    const PlacedLobe placed(kind, lobe, theta);
    const double value = placed.value(wi), aside = placed.aside(wi);
    if (kind == GaussianKind::spherical)
        return {value, value * lobe.sharpness * aside, -value * lobe.sharpness * placed.versine(wi),
                0};
    const double along = placed.along(wi);
    if (along <= 0) return {};
    return {value, value / along * aside * (1 + 2 * lobe.sharpness * along * along),
            -value * lobe.sharpness * aside * aside, -value * lobe.across * wi.y * wi.y};
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
    std::vector<Direction> turned(wi.count);
    for (std::size_t k = 0; k < wi.count; ++k)
        turned[k] = {c * wi.x[k] - s * wi.y[k], s * wi.x[k] + c * wi.y[k], wi.z[k]};
    const auto add = [&](const GaussianElevation& elevation, double weight) {
        if (weight == 0) return;
        for (const GaussianLobe& lobe : elevation.lobes) {
            const PlacedLobe placed(content_.kind, lobe, theta);
            for (std::size_t k = 0; k < wi.count; ++k) {
                const double value = turned[k].z > 0 ? weight * placed.value(turned[k]) : 0;
                if (value == 0) continue;
                for (std::size_t channel = 0; channel < channels; ++channel)
                    out[channel * wi.count + k] += lobe.amplitude[channel] * value;
            }
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
