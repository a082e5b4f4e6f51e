#pragma once

#include <brdfs/fit/normal_equations.h>

#include <hshfit/time_limit.h>

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// A sum of squares at x, with derivatives if asked for.
using SumOfSquares = std::function<Equations(std::span<const double> x, bool derivatives)>;

struct MinimiseOptions {
    int iterations = 200;
    /// Relative change of the cost, and of x, that counts as converged.
    double costTolerance = 1e-12, stepTolerance = 1e-10;
    /// From the eleventh iteration on, the matrix has second derivatives, by differences of
    /// the gradient: where residuals are large, Gauss-Newton's converges by the hundred. A cost
    /// that falls by less than 1e-7 of itself in ten iterations counts as converged then.
    bool curvature = true;
    /// The same sum over a part of its samples. The second derivatives that Gauss-Newton's matrix
    /// lacks are then taken from this sum, from the first iteration on, for the price of fewer
    /// samples. Null: from all samples.
    const SumOfSquares* fewer = nullptr;
    TimeLimit limit = {};  ///< the search ends with it, not converged
};

/// The report of Ceres on a run.
struct Minimum {
    std::vector<double> x;
    double cost = 0;
    bool converged = false;
    std::string message;  ///< Ceres' own
    int iterations = 0;
    int evaluations = 0;
};

/// A local minimum within bounds by Ceres' Levenberg-Marquardt method. The equations reach Ceres as
/// n + 1 residuals with the same cost, gradient and Gauss-Newton matrix. Without parameters it is
/// the point itself, converged. Ceres has to be given finite values; where they are not, it steps
/// back.
Minimum minimise(const SumOfSquares& equations, std::vector<double> start,
                 std::span<const double> lower, std::span<const double> upper,
                 const MinimiseOptions& options = {});

}  // namespace hshfit::brdfs
