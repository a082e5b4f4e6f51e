#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/minimum_study.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

namespace hshfit::brdfs {
namespace {

/// The samples of each scan; without scans each sample is one.
std::vector<std::vector<std::size_t>> membersOf(const FitSamples& samples) {
    std::vector<std::vector<std::size_t>> members;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const std::size_t scan = samples.scans.empty() ? k : samples.scans[k];
        if (scan >= members.size()) members.resize(scan + 1);
        members[scan].push_back(k);
    }
    return members;
}

/// As many scans as there are, drawn with replacement: a sample that comes several times has that
/// weight.
FitSamples redrawn(const FitSamples& samples, const std::vector<std::vector<std::size_t>>& members,
                   std::uint64_t seed, std::size_t draw) {
    std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(draw),
                        static_cast<std::uint32_t>(std::uint64_t{draw} >> 32)};
    std::mt19937_64 random(words);
    std::vector<std::size_t> times(samples.size(), 0);
    for (std::size_t i = 0; i < members.size(); ++i)
        for (const std::size_t k : members[random() % members.size()]) ++times[k];
    std::vector<std::size_t> chosen;
    for (std::size_t k = 0; k < samples.size(); ++k)
        if (times[k] > 0) chosen.push_back(k);
    FitSamples result = samples.subset(chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i)
        result.weights[i] *= static_cast<double>(times[chosen[i]]);
    return result;
}

std::vector<double> valuesAt(const FitProblem& problem, const std::vector<double>& x) {
    std::vector<double> values = x;
    for (std::size_t j = 0; j < problem.shapeCount(); ++j)
        values[j] = problem.sum().shapes()[j].toValue(x[j]);
    return values;
}

/// Between the two nearest of sorted values.
double percentile(const std::vector<double>& sorted, double share) {
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (place - std::floor(place)) * (sorted[above] - sorted[below]);
}

ParameterUncertainty::Bootstrap summarised(std::vector<double> values) {
    std::ranges::sort(values);
    const double count = static_cast<double>(values.size());
    double mean = 0, squares = 0;
    for (const double value : values) mean += value / count;
    for (const double value : values) squares += (value - mean) * (value - mean);
    // The tails beyond one standard deviation of a normal distribution, and 2.5 % each.
    const double tail = 0.5 * std::erfc(std::sqrt(0.5));
    constexpr double outer = 0.025;
    return {.error = std::sqrt(squares / (count - 1)),
            .within68 = {percentile(values, tail), percentile(values, 1 - tail)},
            .within95 = {percentile(values, outer), percentile(values, 1 - outer)}};
}

}  // namespace

void addBootstrap(const StudiedMinimum& minimum, const UncertaintyOptions& options,
                  std::uint64_t seed, Uncertainty& result) {
    const FitProblem& problem = minimum.problem;
    const FitSamples& samples = problem.samples();
    const auto members = membersOf(samples);
    const bool linear = problem.loss() == Loss::Kind::l2 || problem.loss() == Loss::Kind::cosine;
    std::vector<std::vector<double>> draws(options.bootstrap);
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, draws.size(), [&](std::size_t b) {
        const FitSamples own = redrawn(samples, members, seed, b);
        const FitProblem again(own, problem.sum(), problem.loss());
        Minimum start;
        start.x = minimum.x;
        const Minimum found = refined(again, linear, start, {});
        if (found.converged) draws[b] = valuesAt(again, found.x);
        if (options.progress) options.progress(++done, draws.size());
    });
    result.bootstrapDraws = draws.size();
    result.bootstrapFailures =
        static_cast<std::size_t>(std::ranges::count_if(draws, &std::vector<double>::empty));
    std::erase_if(draws, [](const std::vector<double>& draw) { return draw.empty(); });
    if (draws.size() < 2)
        throw NumericError(
            fmt::format("{} of {} fits to resampled data converged; expected at "
                        "least 2",
                        draws.size(), options.bootstrap));
    for (std::size_t i = 0; i < minimum.x.size(); ++i) {
        std::vector<double> values;
        for (const std::vector<double>& draw : draws) values.push_back(draw[i]);
        result.parameters[i].bootstrap = summarised(std::move(values));
    }
}

}  // namespace hshfit::brdfs
