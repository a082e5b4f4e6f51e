#include <hshfit/material_library/internal/least_in_steps.h>

#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace hshfit::material_library {
namespace {

using Eigen::Index;

constexpr std::size_t mostPaths = 32;
constexpr int mostSweeps = 20;

/// The best real numbers within bounds: those at a bound, and the system of the others.
struct Bounded {
    Eigen::VectorXd values;   ///< of all
    std::vector<Index> open;  ///< the numbers that are at no bound
    Eigen::MatrixXd upper;    ///< upper^T upper = gram of the open ones
};

Bounded bounded(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                const Eigen::VectorXd& most) {
    Bounded found{Eigen::VectorXd::Zero(right.size()),
                  std::vector<Index>(static_cast<std::size_t>(right.size())),
                  {}};
    std::iota(found.open.begin(), found.open.end(), Index{0});
    while (!found.open.empty()) {
        const std::vector<Index> open = found.open;
        // Values of open numbers are 0 while the others are taken to the right.
        for (const Index k : open) found.values[k] = 0;
        const Eigen::LLT<Eigen::MatrixXd> factor(gram(open, open));
        const Eigen::VectorXd best = factor.solve((right - gram * found.values)(open));
        found.open.clear();
        for (std::size_t n = 0; n < open.size(); ++n) {
            const double value = best[static_cast<Index>(n)], bound = most[open[n]];
            found.values[open[n]] = std::clamp(value, -bound, bound);
            if (std::abs(value) <= bound) found.open.push_back(open[n]);
        }
        if (found.open.size() < open.size()) continue;
        found.upper = factor.matrixU();
        break;
    }
    return found;
}

/// Open numbers that are rounded so far, in a way of several.
struct Path {
    double cost = 0;
    Index from = 0;  ///< the path that it goes on from
    double off = 0;  ///< the best value less the rounded one, of the last number
};

/// Whole numbers for the open ones, in their order.
Eigen::VectorXd rounded(const Bounded& found, const Eigen::VectorXd& most) {
    const auto size = static_cast<Index>(found.open.size());
    const Eigen::VectorXd best = found.values(found.open);
    Eigen::MatrixXd offs = Eigen::MatrixXd::Zero(size, 1);  // [number][path]
    Eigen::VectorXd costs = Eigen::VectorXd::Zero(1);
    for (Index k = size - 1; k >= 0; --k) {
        const double bound = most[found.open[static_cast<std::size_t>(k)]],
                     diagonal = found.upper(k, k);
        const Eigen::RowVectorXd moved =
            found.upper.row(k).tail(size - k - 1) * offs.bottomRows(size - k - 1) / diagonal;
        std::vector<Path> paths;
        for (Index p = 0; p < costs.size(); ++p) {
            const double free = best[k] + moved[p], near = std::round(free),
                         other = near + (free > near ? 1 : -1);
            const auto add = [&](double value) {
                paths.push_back(
                    {costs[p] + std::pow(diagonal * (free - value), 2), p, best[k] - value});
            };
            add(std::clamp(near, -bound, bound));
            if (std::abs(near) <= bound && std::abs(other) <= bound) add(other);
        }
        std::ranges::stable_sort(paths, {}, &Path::cost);
        if (paths.size() > mostPaths) paths.resize(mostPaths);
        const auto count = static_cast<Index>(paths.size());
        Eigen::MatrixXd next(size, count);
        costs.resize(count);
        for (Index p = 0; p < count; ++p) {
            const Path& path = paths[static_cast<std::size_t>(p)];
            next.col(p) = offs.col(path.from);
            next(k, p) = path.off;
            costs[p] = path.cost;
        }
        offs = std::move(next);
    }
    return best - offs.col(0);
}

/// Changes single numbers as long as that makes the sum less.
void descend(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right, const Eigen::VectorXd& most,
             Eigen::VectorXd& numbers) {
    Eigen::VectorXd slope = right - gram * numbers;
    for (int sweep = 0; sweep < mostSweeps; ++sweep) {
        bool changed = false;
        for (Index k = 0; k < numbers.size(); ++k) {
            const double to = std::clamp(std::round(numbers[k] + slope[k] / gram(k, k)), -most[k],
                                         most[k]),
                         step = to - numbers[k];
            if (step == 0 || step * (step * gram(k, k) - 2 * slope[k]) >= 0) continue;
            slope -= step * gram.col(k);
            numbers[k] = to;
            changed = true;
        }
        if (!changed) break;
    }
}

}  // namespace

Eigen::VectorXd leastInSteps(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                             const Eigen::VectorXd& most) {
    const Bounded found = bounded(gram, right, most);
    Eigen::VectorXd numbers = found.values;
    if (!found.open.empty()) numbers(found.open) = rounded(found, most);
    // The sums above leave the digits of a whole number.
    numbers = numbers.array().round();
    descend(gram, right, most, numbers);
    return numbers;
}

}  // namespace hshfit::material_library
