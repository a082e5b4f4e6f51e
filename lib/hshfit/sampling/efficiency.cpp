#include <hshfit/sampling/efficiency.h>

#include <hshfit/brdf/uniform.h>
#include <hshfit/sampling/internal/target.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline sampling {

Uniforms UniformNumbers::next() {
    Uniforms u;
    for (double& value : u) value = uniform(random_);
    return u;
}

namespace {

/// Mean and variance by Welford's steps.
struct Moments {
    double count = 0, mean = 0, squares = 0;

    void add(double value) {
        ++count;
        const double change = value - mean;
        mean += change / count;
        squares += change * (value - mean);
    }
    double variance() const { return count > 1 ? squares / (count - 1) : 0; }
    double errorOfMean() const { return count > 0 ? std::sqrt(variance() / count) : 0; }
};

}  // namespace

Efficiency efficiencyAt(const Brdf& brdf, const Sampler& sampler, const Direction& wo,
                        std::size_t samples, std::uint64_t seed) {
    const std::size_t channels = brdf.channels().count();
    UniformNumbers numbers(seed);
    Moments weight;
    std::vector<Moments> albedo(channels);
    std::vector<double> f(channels);
    Efficiency result{.wo = wo, .samples = samples, .albedo = {}, .albedoError = {}};
    std::size_t wasted = 0;
    for (std::size_t k = 0; k < samples; ++k) {
        const Sample sample = sampler.sample(wo, numbers.next());
        std::ranges::fill(f, 0.0);
        if (sample.pdf > 0) brdf.eval(wo, {&sample.wi.x, &sample.wi.y, &sample.wi.z, 1}, f.data());
        const double scale = sample.pdf > 0 ? sample.wi.z / sample.pdf : 0;
        const double value = meanMagnitude(f, 0, 1, channels) * scale;
        weight.add(value);
        result.largest = std::max(result.largest, value);
        wasted += value == 0;
        for (std::size_t c = 0; c < channels; ++c)
            albedo[c].add(std::isfinite(f[c]) ? f[c] * scale : 0);
    }
    result.mean = weight.mean;
    result.standardError = weight.errorOfMean();
    if (weight.mean > 0) {
        result.variance = weight.variance() / (weight.mean * weight.mean);
        result.largest /= weight.mean;
    }
    result.wasted = samples > 0 ? static_cast<double>(wasted) / static_cast<double>(samples) : 0;
    for (const Moments& channel : albedo) {
        result.albedo.push_back(channel.mean);
        result.albedoError.push_back(channel.errorOfMean());
    }
    return result;
}

}  // namespace hshfit::inline sampling
