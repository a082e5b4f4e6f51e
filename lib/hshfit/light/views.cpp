#include <hshfit/light/views.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hshfit::inline light {
namespace {

constexpr double golden = 0.6180339887498949;  // (sqrt 5 - 1) / 2

/// Share of the mean radiance below which differences are not seen.
constexpr double floorShare = 0.01;

struct Sums {
    double error = 0, truth = 0, weight = 0;
};

/// Weighted mean of L over views, orientations and channels.
double meanRadiance(const Views& views, std::span<const Radiance> truth) {
    double sum = 0, weight = 0;
    for (const Radiance& each : truth) {
        for (std::size_t v = 0; v < views.size(); ++v) {
            for (double value : each[v]) sum += views.weights[v] * value;
            weight += 3 * views.weights[v];
        }
    }
    return weight > 0 ? sum / weight : 0;
}

Sums sumsOf(const Budget& budget, const Views& views, std::span<const Radiance> truth,
            std::span<const Radiance> approximation, std::optional<std::size_t> ring) {
    const double floor = floorShare * meanRadiance(views, truth);
    Sums sums;
    for (std::size_t o = 0; o < truth.size(); ++o) {
        for (std::size_t v = 0; v < views.size(); ++v) {
            if (ring && views.rings[v] != *ring) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                const double w = views.weights[v], l = truth[o][v][c], m = approximation[o][v][c];
                sums.truth += w * l * l;
                sums.weight += w;
                sums.error += budget.metric == Budget::Metric::relativeL2
                                  ? w * (m - l) * (m - l)
                                  : w * std::abs(std::log((std::max(m, 0.0) + floor) /
                                                          (std::max(l, 0.0) + floor)));
            }
        }
    }
    return sums;
}

double errorFrom(const Budget& budget, const Sums& sums) {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (!std::isfinite(sums.error)) return sums.truth > 0 ? none : 0;
    if (budget.metric == Budget::Metric::log) return sums.error / sums.weight;
    if (!(sums.truth > 0)) return sums.error > 0 ? none : 0;
    return std::sqrt(sums.error / sums.truth);
}

}  // namespace

std::string_view metricName(Budget::Metric metric) {
    return metric == Budget::Metric::log ? "log" : "relative_l2";
}

Views viewsOf(const ViewRange& range, double step, double shift) {
    const double width = range.thetaMax - range.thetaMin, around = range.phiMax - range.phiMin;
    const auto count = [&](double angle) {
        return std::max(1, static_cast<int>(std::ceil(angle / radians(step) - 1e-9)));
    };
    const int rings = count(width);
    Views views;
    for (int r = 0; r < rings; ++r) {
        const double low = range.thetaMin + width * r / rings;
        const double high = range.thetaMin + width * (r + 1) / rings;
        const double theta = (low + high) / 2;
        // Four times as far apart as elevations: rings are turned against each other.
        const int azimuths = count(around / 4);
        const double weight =
            width > 0 ? 2 * std::sin(theta) * std::sin((high - low) / 2) / azimuths : 1;
        for (int j = 0; j < azimuths; ++j) {
            const double turn = 0.5 + shift + r * golden;
            const double at = around > 0 ? (j + turn - std::floor(turn)) / azimuths : 0;
            views.directions.push_back(directionFromAngles(theta, range.phiMin + at * around));
            views.weights.push_back(weight);
            views.rings.push_back(static_cast<std::size_t>(r));
        }
        views.thetas.push_back(theta);
    }
    return views;
}

Views subset(const Views& views, std::span<const std::size_t> indices) {
    Views result{.directions = {}, .weights = {}, .rings = {}, .thetas = views.thetas};
    for (std::size_t i : indices) {
        result.directions.push_back(views.directions[i]);
        result.weights.push_back(views.weights[i]);
        result.rings.push_back(views.rings[i]);
    }
    return result;
}

double errorOf(const Budget& budget, const Views& views, std::span<const Radiance> truth,
               std::span<const Radiance> approximation) {
    return errorFrom(budget, sumsOf(budget, views, truth, approximation, {}));
}

std::vector<double> errorsByElevation(const Budget& budget, const Views& views,
                                      std::span<const Radiance> truth,
                                      std::span<const Radiance> approximation) {
    std::vector<double> errors;
    for (std::size_t ring = 0; ring < views.thetas.size(); ++ring) {
        errors.push_back(errorFrom(budget, sumsOf(budget, views, truth, approximation, ring)));
    }
    return errors;
}

}  // namespace hshfit::inline light
