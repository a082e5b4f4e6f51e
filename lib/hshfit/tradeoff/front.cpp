#include <hshfit/tradeoff/internal/front.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::tradeoff {

std::vector<std::size_t> paretoFront(std::span<const double> costs,
                                     std::span<const double> errors) {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < costs.size(); ++k) {
        if (std::isfinite(costs[k]) && std::isfinite(errors[k])) order.push_back(k);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return costs[a] != costs[b] ? costs[a] < costs[b] : errors[a] < errors[b];
    });
    std::vector<std::size_t> front;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t k : order) {
        if (!(errors[k] < least)) continue;
        least = errors[k];
        front.push_back(k);
    }
    return front;
}

std::optional<std::size_t> kneeOf(std::span<const std::size_t> front, std::span<const double> costs,
                                  std::span<const double> errors) {
    if (front.empty()) return std::nullopt;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t k : front) {
        if (errors[k] > 0) least = std::min(least, errors[k]);
    }
    const auto x = [&](std::size_t k) { return std::log(costs[k]); };
    const auto y = [&](std::size_t k) { return std::log(std::max(errors[k], least / 1000)); };
    const double left = x(front.front()), width = x(front.back()) - left;
    const double top = y(front.front()), height = top - y(front.back());
    std::size_t best = front.back();
    double depth = 1e-9;  // the ends of the front are on the line, within rounding
    for (const std::size_t k : front) {
        const double below = (top - y(k)) / height - (x(k) - left) / width;
        if (below > depth) {
            depth = below;
            best = k;
        }
    }
    return best;
}

}  // namespace hshfit::tradeoff
