#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/minimum_study.h>
#include <brdfs/fit/percentiles.h>
#include <brdfs/fit/resampling.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// Samples drawn with replacement: one that comes several times has that weight.
FitSamples redrawn(const FitSamples& samples, const std::vector<std::vector<std::size_t>>& members,
                   std::uint64_t seed, std::size_t draw) {
    const std::vector<std::size_t> times = timesDrawn(members, samples.size(), seed, draw);
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

}  // namespace

void addBootstrap(const StudiedMinimum& minimum, const UncertaintyOptions& options,
                  std::uint64_t seed, Uncertainty& result) {
    const FitProblem& problem = minimum.problem;
    const FitSamples& samples = problem.samples();
    const auto members = scanMembers(samples);
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
