#include <brdfs/fit/percentiles.h>

#include <algorithm>
#include <cmath>

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

}  // namespace hshfit::brdfs
