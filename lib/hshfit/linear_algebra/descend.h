#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hshfit::linear_algebra {

/// The range in which a search may move along one coordinate, and the step that it begins with.
struct SearchAxis {
    double step, low, high;
};

/// Lowers f(x) from a node of a grid towards the local minimum next to it: along one coordinate
/// after the other, and then along the way that these have gone, to the vertex of the parabola
/// through x and both neighbours (or to the lower of these), with steps that halve after each
/// sweep. Never ends higher than it began. Returns the value; x is moved.
template <class F>
double descend(F&& f, std::vector<double>& x, const std::vector<SearchAxis>& axes, int sweeps = 7) {
    double best = f(x), scale = 1;
    std::vector<double> way(x.size()), to(x.size());
    const auto at = [&](const std::vector<double>& from, double along) {
        for (std::size_t a = 0; a < axes.size(); ++a) {
            to[a] = std::clamp(from[a] + along * way[a], axes[a].low, axes[a].high);
        }
        return f(to);
    };
    const auto search = [&] {
        const std::vector<double> from = x;
        const double middle = best;
        const auto take = [&](double along) {
            const double value = at(from, along);
            if (value < best) best = value, x = to;
            return value;
        };
        const double below = take(-1), above = take(1), bend = below - 2 * middle + above;
        if (bend > 0) take(std::clamp(0.5 * (below - above) / bend, -1.0, 1.0));
    };
    for (int sweep = 0; sweep < sweeps; ++sweep, scale /= 2) {
        const std::vector<double> before = x;
        for (std::size_t a = 0; a < axes.size(); ++a) {
            if (axes[a].step == 0) continue;
            std::fill(way.begin(), way.end(), 0.0);
            way[a] = scale * axes[a].step;
            search();
        }
        for (std::size_t a = 0; a < axes.size(); ++a) way[a] = x[a] - before[a];
        search();
    }
    return best;
}

}  // namespace hshfit::linear_algebra

namespace hshfit {
using linear_algebra::descend;
using linear_algebra::SearchAxis;
}  // namespace hshfit
