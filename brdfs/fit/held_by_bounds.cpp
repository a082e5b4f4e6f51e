#include <brdfs/fit/held_by_bounds.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hshfit::brdfs {

HeldByBounds heldByBounds(std::span<const double> x, const Equations& equations,
                          const Bounds& bounds) {
    const std::size_t n = x.size();
    HeldByBounds result;
    for (std::size_t i = 0; i < n; ++i) {
        const double reach = 1e-9 * (1 + std::abs(x[i])), pull = equations.gradient[i];
        std::string bound;
        if (x[i] <= bounds.lower[i] + reach && pull >= 0) bound = "lower";
        if (x[i] >= bounds.upper[i] - reach && pull <= 0) bound = "upper";
        const double scale = std::sqrt(std::max(equations.hessian[i * n + i], 0.0));
        const double negligible = 1e-6 * std::sqrt(2 * equations.cost) + 1e-12;
        result.fixed.push_back(!bound.empty() && std::abs(pull) > negligible * scale);
        if (!result.fixed[i] && scale > 0)
            result.projectedGradient = std::max(result.projectedGradient, std::abs(pull) / scale);
        result.bound.push_back(std::move(bound));
    }
    return result;
}

}  // namespace hshfit::brdfs
