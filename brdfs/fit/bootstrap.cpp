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

std::vector<double> valuesAt(const FitProblem& problem, const std::vector<double>& x) {
    std::vector<double> values = x;
    for (std::size_t j = 0; j < problem.shapeCount(); ++j)
        values[j] = problem.sum().shapes()[j].toValue(x[j]);
    return values;
}

}  // namespace

void addBootstrap(const Refit& refit, const UncertaintyOptions& options, Uncertainty& result) {
    std::vector<std::vector<double>> draws(options.bootstrap);
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, draws.size(), [&](std::size_t b) {
        draws[b] = refit(b);
        if (options.progress) options.progress(++done, draws.size());
    });
    result.bootstrapDraws = draws.size();
    result.bootstrapFailures =
        static_cast<std::size_t>(std::ranges::count_if(draws, &std::vector<double>::empty));
    const std::size_t converged = draws.size() - result.bootstrapFailures;
    if (converged < 2)
        throw NumericError(
            fmt::format("{} of {} fits to resampled data converged; expected at least 2", converged,
                        draws.size()));
    const std::size_t count = std::ranges::find_if_not(draws, &std::vector<double>::empty)->size();
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<double> values;
        for (const std::vector<double>& draw : draws)
            if (!draw.empty()) values.push_back(draw[i]);
        result.parameters[i].bootstrap = summarised(std::move(values));
    }
    result.draws = std::move(draws);
}

void addBootstrap(const StudiedMinimum& minimum, const UncertaintyOptions& options,
                  std::uint64_t seed, Uncertainty& result) {
    const FitProblem& problem = minimum.problem;
    const bool linear = problem.isLinear();
    const auto refit = [&](std::size_t b) {
        const FitSamples own = redrawn(problem.samples(), seed, b);
        const FitProblem again(own, problem.sum(), problem.loss());
        Minimum start;
        start.x = minimum.x;
        const Minimum found = refined(again, linear, start, {});
        return found.converged ? valuesAt(again, found.x) : std::vector<double>();
    };
    addBootstrap(refit, options, result);
}

}  // namespace hshfit::brdfs
