#include <brdfs/fit/percentiles.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {

double percentile(const std::vector<double>& sorted, double share) {
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (place - std::floor(place)) * (sorted[above] - sorted[below]);
}

ParameterUncertainty::Bootstrap summarised(std::vector<double> draws) {
    std::ranges::sort(draws);
    const double count = static_cast<double>(draws.size());
    double mean = 0, squares = 0;
    for (const double value : draws) mean += value / count;
    for (const double value : draws) squares += (value - mean) * (value - mean);
    // The tails beyond one standard deviation of a normal distribution, and 2.5 % each.
    const double tail = 0.5 * std::erfc(std::sqrt(0.5));
    constexpr double outer = 0.025;
    return {.error = std::sqrt(squares / (count - 1)),
            .within68 = {percentile(draws, tail), percentile(draws, 1 - tail)},
            .within95 = {percentile(draws, outer), percentile(draws, 1 - outer)}};
}

double decadesOf(const FitSamples& samples) {
    std::vector<double> values;
    for (std::size_t k = 0; k < samples.values.size(); ++k) {
        const double value = samples.values[k] * samples.wiZ[k % samples.size()];
        if (value > 0) values.push_back(value);
    }
    if (values.size() < 2) return 0;
    std::ranges::sort(values);
    return std::log10(percentile(values, 0.95) / percentile(values, 0.05));
}

std::optional<SampleFactors> factorsOf(std::span<const double> values, const FitSamples& samples) {
    std::vector<double> factors;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double measured = samples.values[k], model = values[k];
        if (!(measured > 0)) continue;
        factors.push_back(model > 0 ? std::max(model / measured, measured / model)
                                    : std::numeric_limits<double>::infinity());
    }
    if (factors.empty()) return std::nullopt;
    std::ranges::sort(factors);
    // Between infinite values there is no mean.
    const auto at = [&](double share) {
        return factors[static_cast<std::size_t>(share * static_cast<double>(factors.size() - 1))];
    };
    return SampleFactors{at(0.5), at(0.9), factors.size()};
}

}  // namespace hshfit::brdfs
