#include <hshfit/tradeoff/timing.h>

#include <hshfit/brdf/uniform.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

namespace hshfit::tradeoff {
namespace {

constexpr double leastSeconds = 2e-4;

/// Uniform over the hemisphere.
struct Directions {
    std::vector<double> x, y, z;

    Directions(std::size_t count, unsigned seed) {
        std::mt19937_64 random(seed);
        for (std::size_t k = 0; k < count; ++k) {
            const double mu = 1 - uniform(random), phi = 2 * pi * uniform(random);
            const double s = std::sqrt((1 - mu) * (1 + mu));
            x.push_back(s * std::cos(phi));
            y.push_back(s * std::sin(phi));
            z.push_back(mu);
        }
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), x.size()}; }
    DirectionBatch one(std::size_t k) const { return {&x[k], &y[k], &z[k], 1}; }
};

PairTime summarised(std::vector<double> times) {
    std::sort(times.begin(), times.end());
    const auto quantile = [&](double q) {
        return times[static_cast<std::size_t>(
            std::lround(q * static_cast<double>(times.size() - 1)))];
    };
    return {quantile(0.5), quantile(0.25), quantile(0.75)};
}

/// Nanoseconds for each of the pairs that one call of `work` evaluates, in a loop of `calls`.
template <class Work>
double perPair(const Work& work, std::size_t calls, std::size_t pairsPerCall) {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < calls; ++k) work(k);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    return took.count() / static_cast<double>(calls * pairsPerCall);
}

/// Calls that take the least time that is worth measuring.
template <class Work>
std::size_t callsFor(const Work& work) {
    work(0);
    std::size_t calls = 1;
    while (perPair(work, calls, 1) * 1e-9 * static_cast<double>(calls) < leastSeconds) calls *= 2;
    return calls;
}

}  // namespace

std::vector<FormTime> timePairs(std::span<const PairEvaluator* const> evaluators,
                                std::size_t channels, const TimingOptions& options) {
    const Directions wi(options.batch, 1), wo(options.batch, 2);
    std::vector<float> out(channels * options.batch);
    const auto whole = [&](const PairEvaluator& evaluator) {
        return [&](std::size_t) { evaluator.evaluate(wi.batch(), wo.batch(), out.data()); };
    };
    const auto single = [&](const PairEvaluator& evaluator) {
        return [&](std::size_t k) {
            const std::size_t at = k % options.batch;
            evaluator.evaluate(wi.one(at), wo.one(at), out.data());
        };
    };
    const std::size_t count = evaluators.size();
    std::vector<std::size_t> wholeCalls, singleCalls;
    for (const PairEvaluator* evaluator : evaluators) {
        wholeCalls.push_back(callsFor(whole(*evaluator)));
        singleCalls.push_back(callsFor(single(*evaluator)));
    }
    std::vector<std::vector<double>> wholeTimes(count), singleTimes(count);
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
        for (std::size_t k = 0; k < count; ++k) {
            wholeTimes[k].push_back(perPair(whole(*evaluators[k]), wholeCalls[k], options.batch));
            singleTimes[k].push_back(perPair(single(*evaluators[k]), singleCalls[k], 1));
        }
    }
    std::vector<FormTime> result;
    for (std::size_t k = 0; k < count; ++k) {
        result.push_back(
            {summarised(std::move(wholeTimes[k])), summarised(std::move(singleTimes[k]))});
        if (options.done) options.done();
    }
    return result;
}

}  // namespace hshfit::tradeoff
