#include <hshfit/representation/halfway/halfway_envelope.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

/// The node below `x` in [0, 1] and how far x is from it to the next.
std::pair<std::size_t, double> cellOf(double x, std::size_t nodes) {
    if (nodes == 1) return {0, 0.0};
    const double place = std::clamp(x, 0.0, 1.0) * static_cast<double>(nodes - 1);
    const std::size_t below = std::min(static_cast<std::size_t>(place), nodes - 2);
    return {below, place - static_cast<double>(below)};
}

}  // namespace

EnvelopePoint envelopePoint(const Direction& wi, const Direction& wo) {
    const double high = wo.z - wi.z, across = std::hypot(wo.x, wo.y) - std::hypot(wi.x, wi.y);
    const double a = std::sqrt(std::min(1.0, (high * high + across * across) / 2));
    return {high < 0 ? -a : a, std::sqrt(std::sqrt(std::max(0.0, std::min(wi.z, wo.z))))};
}

HalfwayEnvelope::HalfwayEnvelope(const EnvelopeArray& array, std::size_t channels, bool reciprocal,
                                 const std::string& where)
    : channels_(channels), ridge_(array.ridge), reciprocal_(reciprocal), logs_(array.logs.values) {
    const auto& shape = array.logs.shape;
    if (shape.size() != 3 || shape[0] == 0 || shape[1] == 0 || shape[2] != channels ||
        logs_.size() != shape[0] * shape[1] * shape[2]) {
        throw InputError(fmt::format(
            "{}: the array 'envelope' has to be nodes x nodes x {} channels", where, channels));
    }
    if (!(ridge_ > 0) || !std::isfinite(ridge_)) {
        throw InputError(
            fmt::format("{}: the ridge of the envelope has to be above 0, not {}", where, ridge_));
    }
    alongB_ = shape[0];
    alongA_ = shape[1];
}

HalfwayEnvelope::Mix HalfwayEnvelope::mixAt(const EnvelopePoint& point) const {
    const double spread = point.a * (1 + ridge_) / (std::abs(point.a) + ridge_);
    const double along = reciprocal_ ? std::abs(spread) : (spread + 1) / 2;
    const auto [a, x] = cellOf(along, alongA_);
    const auto [b, y] = cellOf(point.b, alongB_);
    const std::size_t right = alongA_ > 1 ? 1 : 0, up = alongB_ > 1 ? alongA_ : 0;
    const std::size_t first = b * alongA_ + a;
    return {{first, first + right, first + up, first + up + right},
            {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y}};
}

double HalfwayEnvelope::logAt(const Mix& mix, std::size_t channel) const {
    double sum = 0;
    for (std::size_t n = 0; n < 4; ++n) {
        sum += mix.weight[n] * logs_[mix.node[n] * channels_ + channel];
    }
    return sum;
}

}  // namespace hshfit::inline representation::inline halfway
