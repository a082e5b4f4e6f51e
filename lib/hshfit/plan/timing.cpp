#include <hshfit/plan/internal/timing.h>

#include <hshfit/representation/forms/pair_evaluators.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

namespace hshfit::plan {
namespace {

constexpr std::size_t pairs = 4096;
constexpr int runs = 31;

struct Directions {
    std::vector<double> x, y, z;
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), x.size()}; }
};

/// Directions spread over the hemisphere by multiples of an irrational step.
Directions directions(double step) {
    Directions result;
    for (std::size_t k = 0; k < pairs; ++k) {
        const double at = step * static_cast<double>(k);
        const Direction d = directionFromAngles(
            std::acos(1 - (static_cast<double>(k) + 0.5) / pairs), 2 * pi * (at - std::floor(at)));
        result.x.push_back(d.x);
        result.y.push_back(d.y);
        result.z.push_back(d.z);
    }
    return result;
}

}  // namespace

double nanosecondsPerPair(const Representation& representation, const BrdfOpener& open) {
    const auto evaluator = pairEvaluator(representation, open);
    const Directions wi = directions(std::sqrt(2.0));
    Directions wo = directions(std::sqrt(3.0));
    // The shuffle keeps elevations of wo independent of those of wi.
    for (auto* axis : {&wo.x, &wo.y, &wo.z}) {
        std::vector<double> shuffled(pairs);
        for (std::size_t k = 0; k < pairs; ++k) shuffled[k] = (*axis)[k * 1597 % pairs];
        *axis = std::move(shuffled);
    }
    std::vector<float> out(pairs * representation.head.channels.count());
    std::vector<double> times;
    for (int run = 0; run < runs; ++run) {
        const auto start = std::chrono::steady_clock::now();
        evaluator->evaluate(wi.batch(), wo.batch(), out.data());
        const std::chrono::duration<double, std::nano> time =
            std::chrono::steady_clock::now() - start;
        times.push_back(time.count() / pairs);
    }
    std::nth_element(times.begin(), times.begin() + runs / 2, times.end());
    return times[runs / 2];
}

}  // namespace hshfit::plan
