#pragma once

#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/normal_equations.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The parameters of a minimum that rest at bounds.
struct HeldByBounds {
    /// "lower" or "upper" for a parameter that lies at this bound while the cost falls beyond it;
    /// empty for others, a minimum that happens to lie at a bound included.
    std::vector<std::string> bound;
    /// Whether the bound holds it. With next to no pull it could as well leave the bound: the
    /// covariance tells then how much the data say about it.
    std::vector<bool> fixed;
    double projectedGradient = 0;  ///< FitResult::projectedGradient
};

/// `equations` are at x, with derivatives.
HeldByBounds heldByBounds(std::span<const double> x, const Equations& equations,
                          const Bounds& bounds);

}  // namespace hshfit::brdfs
