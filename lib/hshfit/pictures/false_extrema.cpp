#include <hshfit/pictures/internal/false_extrema.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

namespace hshfit::inline pictures {
namespace {

constexpr double nearby = 5;  // degrees within which a dip of the source excuses one of the form

/// The depth of every point below the lower of its highest shoulders; 0 where it has none.
std::vector<double> dipsOf(std::span<const double> values) {
    constexpr double none = -std::numeric_limits<double>::infinity();
    std::vector<double> depths(values.size());
    double highest = none;
    for (std::size_t k = 0; k < values.size(); ++k) {
        depths[k] = highest;
        highest = std::max(highest, values[k]);
    }
    highest = none;
    for (std::size_t k = values.size(); k-- > 0;) {
        depths[k] = std::max(0.0, std::min(depths[k], highest) - values[k]);
        highest = std::max(highest, values[k]);
    }
    return depths;
}

/// The largest of `depths` within `nearby` of the k-th angle.
double deepestNear(std::span<const double> depths, std::span<const double> angles, std::size_t k) {
    const auto first =
        std::lower_bound(angles.begin(), angles.end(), angles[k] - nearby) - angles.begin();
    const auto last =
        std::upper_bound(angles.begin(), angles.end(), angles[k] + nearby) - angles.begin();
    return *std::max_element(depths.begin() + first, depths.begin() + last);
}

}  // namespace

LineDip falseDip(std::span<const double> f, std::span<const double> g,
                 std::span<const double> angles) {
    assert(f.size() == g.size() && f.size() == angles.size());
    const std::vector<double> own = dipsOf(g), excused = dipsOf(f);
    LineDip deepest;
    for (std::size_t k = 1; k + 1 < g.size(); ++k) {
        if (own[k] <= deepest.depth) continue;
        const double less = g[k] + 2 * deepestNear(excused, angles, k);
        // Each side has its own best shoulder, since the least of both sides counts.
        const auto shoulder = [&](std::size_t from, std::size_t to) {
            double best = 0;
            for (std::size_t a = from; a < to; ++a)
                best = std::max(best, std::min(g[a] - less, (g[a] - f[a]) - (g[k] - f[k])));
            return best;
        };
        const double depth = std::min(shoulder(0, k), shoulder(k + 1, g.size()));
        if (depth > deepest.depth) deepest = {depth, k};
    }
    return deepest;
}

double relativeDepth(double depth) {
    return 1 - std::exp(-depth);
}

}  // namespace hshfit::inline pictures
