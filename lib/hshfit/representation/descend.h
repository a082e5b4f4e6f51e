#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hshfit {

/// Where a search may move along one coordinate, and how far at first.
struct SearchAxis {
    double step, low, high;
};

/// Lowers f(x) from a node of a grid towards the local minimum next to it: along one coordinate
/// after the other to the vertex of the parabola through x and both neighbours (or to the lower of
/// these), with steps that halve after each sweep. Never ends higher than it began. Returns the
/// value; x is moved.
template <class F>
double descend(F&& f, std::vector<double>& x, const std::vector<SearchAxis>& axes, int sweeps = 7) {
    double best = f(x), scale = 1;
    for (int sweep = 0; sweep < sweeps; ++sweep, scale /= 2) {
        for (std::size_t a = 0; a < axes.size(); ++a) {
            const double centre = x[a], step = scale * axes[a].step;
            const auto at = [&](double to) {
                x[a] = std::clamp(to, axes[a].low, axes[a].high);
                return f(x);
            };
            double chosen = centre;
            const double middle = best;
            const auto take = [&](double to, double value) {
                if (value < best) best = value, chosen = std::clamp(to, axes[a].low, axes[a].high);
            };
            const double below = at(centre - step), above = at(centre + step);
            take(centre - step, below);
            take(centre + step, above);
            const double bend = below - 2 * middle + above;
            if (bend > 0) {
                const double vertex =
                    centre + std::clamp(0.5 * (below - above) / bend, -1.0, 1.0) * step;
                take(vertex, at(vertex));
            }
            x[a] = chosen;
        }
    }
    return best;
}

}  // namespace hshfit
