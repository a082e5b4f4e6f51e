#pragma once

#include <hshfit/representation/forms/pair_evaluators.h>

#include <functional>
#include <span>
#include <vector>

namespace hshfit::tradeoff {

/// Nanoseconds for one pair of directions, all channels.
struct PairTime {
    double median = 0;
    double low = 0, high = 0;  ///< quartiles of the repeats
};

struct FormTime {
    PairTime batch;   ///< 4096 pairs a call
    PairTime single;  ///< one pair a call
};

struct TimingOptions {
    int repeats = 11;
    std::size_t batch = 4096;
    std::function<void()> done = {};  ///< after each evaluator
};

/// Evaluation times on this thread. Repeats are interleaved: every evaluator once, then every one
/// again, so that a slow spell of the machine falls on all alike. Each repeat takes about 0.2 ms
/// at least. The pairs are uniform over both hemispheres, in an order without pattern.
std::vector<FormTime> timePairs(std::span<const PairEvaluator* const> evaluators,
                                std::size_t channels, const TimingOptions& options = {});

}  // namespace hshfit::tradeoff
