#include <hshfit/lighting/lobe_kernel.h>

#include <hshfit/lighting/lobe_nodes.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::lighting {
namespace {

constexpr std::size_t samples = 512;    // of the shape, even in ln t
constexpr double narrowest = 1e-5;      // in t
constexpr std::size_t entries = 16384;  // of a tabulated kernel
constexpr double leastScale = 1e-3, mostScale = 30;

/// The directions at which f is looked up: along the meridian of +x, or to both sides of an axis.
struct ProfileDirections {
    std::vector<double> x, y, z;

    void addMeridian(double t) {
        x.push_back(2 * t / (1 + t * t));
        y.push_back(0);
        z.push_back(std::max(0.0, (1 - t * t) / (1 + t * t)));
    }
    /// Both sides of an axis, one after the other.
    void addSides(const Direction& axis, double angle, const std::vector<double>& ts) {
        const Direction across = AcrossAxis(axis).at(angle);
        for (const double side : {1.0, -1.0}) {
            for (const double t : ts) {
                const double c = (1 - t * t) / (1 + t * t), s = side * 2 * t / (1 + t * t);
                x.push_back(c * axis.x + s * across.x);
                y.push_back(c * axis.y + s * across.y);
                z.push_back(std::max(0.0, c * axis.z + s * across.z));
            }
        }
    }
};

}  // namespace

LobeKernel::LobeKernel(const Brdf& brdf, double evenShare) {
    const Direction normal{0, 0, 1};
    const LobeNodes nodes = lobeNodes(brdf, normal, 2);
    const LobeSummary upright = summarise(nodes, evenShare);
    const bool round = lobesInPlane(brdf.laws());
    ProfileDirections profile;
    for (std::size_t k = 0; k < samples; ++k) {
        const double t =
            narrowest * std::pow(1 / narrowest, static_cast<double>(k) / (samples - 1));
        t_.push_back(t);
        if (round) profile.addMeridian(t);
    }
    if (!round) profile.addSides(upright.axis, spreadOf(nodes, upright).angle() + pi / 2, t_);
    const std::size_t channels = brdf.channels().count(), count = profile.x.size();
    std::vector<double> f(channels * count);
    brdf.eval(normal, {profile.x.data(), profile.y.data(), profile.z.data(), count}, f.data());
    bool any = false;
    values_.resize(samples);
    for (std::size_t k = 0; k < count; ++k) {
        double value = 0;
        for (std::size_t c = 0; c < channels; ++c) value += f[c * count + k] - upright.even[c] / pi;
        values_[k % samples] += std::max(0.0, value) * profile.z[k];
        any = any || value > 1e-9 * upright.albedo[0];
    }
    const Rgb& rest = upright.rest;
    if (any && rest[0] + rest[1] + rest[2] > 0) return;
    for (std::size_t k = 0; k < samples; ++k)
        values_[k] = std::max(0.0, (1 - t_[k] * t_[k]) / (1 + t_[k] * t_[k]));
}

LobeKernel::LobeKernel(std::vector<double> t, std::vector<double> values)
    : t_(std::move(t)), values_(std::move(values)) {
    assert(t_.size() == values_.size() && t_.size() > 1 && t_.back() <= 1);
}

double LobeKernel::shape(double t) const {
    if (t <= t_.front()) return values_.front();
    if (t >= t_.back()) return t > t_.back() * (1 + 1e-12) ? 0 : values_.back();
    const auto after = static_cast<std::size_t>(std::ranges::upper_bound(t_, t) - t_.begin());
    const double share = (t - t_[after - 1]) / (t_[after] - t_[after - 1]);
    return values_[after - 1] + share * (values_[after] - values_[after - 1]);
}

// d omega = 2 pi sin(alpha) d alpha, with sin(alpha) = 2 t / (1 + t^2), d alpha = 2 d t / (1 +
// t^2); even steps in ln t of the shape's own argument resolve it at every scale.
LobeKernel::Moments LobeKernel::moments(double scale) const {
    constexpr int steps = 2000;
    const double from = std::log(t_.front() / 100), to = std::log(t_.back());
    const double step = (to - from) / steps;
    Moments result;
    for (int k = 0; k < steps; ++k) {
        const double u = std::exp(from + (k + 0.5) * step), t = u * scale;
        const double weight = 8 * pi * t * t / std::pow(1 + t * t, 2) * step * shape(u);
        result.integral += weight;
        result.meanCosine += weight * (1 - t * t) / (1 + t * t);
        result.meanSquare += weight * std::pow((1 - t * t) / (1 + t * t), 2);
    }
    result.meanCosine /= result.integral;
    result.meanSquare /= result.integral;
    return result;
}

double LobeKernel::meanCosine(double scale) const {
    return moments(scale).meanCosine;
}

double LobeKernel::scaleFor(double cosine) const {
    double low = std::log(leastScale), high = std::log(mostScale);
    for (int k = 0; k < 50; ++k) {
        const double middle = (low + high) / 2;
        (meanCosine(std::exp(middle)) > cosine ? low : high) = middle;
    }
    return std::exp((low + high) / 2);
}

LobeKernel::Scaled LobeKernel::scaled(double scale) const {
    const double integral = moments(scale).integral;
    Scaled result;
    for (std::size_t k = 0; k <= entries; ++k) {
        const double half = static_cast<double>(k) / entries;  // sin(alpha / 2)
        const double t = half / std::sqrt(std::max(1 - half * half, 1e-12));
        result.table_.push_back(static_cast<float>(shape(t / scale) / integral));
    }
    return result;
}

}  // namespace hshfit::lighting
