#pragma once

#include <brdfs/fit/fit_options.h>
#include <brdfs/fit/fit_result.h>
#include <brdfs/fit/minimise.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/parametric_sum.h>

#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

struct Bounds {
    std::vector<double> lower, upper;
};

/// Bounds of x: the shapes' u, then linear parameters (FitProblem::joint).
Bounds jointBounds(const ParametricSum& sum, std::size_t channels);

/// The least minimum that the searches of a fit found, with the scale of the robust kernel.
struct Fitted {
    Minimum minimum;
    double robustScale = 0;
};

/// Searches from several starts (FitOptions); sets the robust kernel of the problem.
Fitted searchMinimum(FitProblem& problem, const FitOptions& options);

/// The scale at which a robust kernel sets in by default: FitOptions::robustScale.
double robustScaleOf(Robust robust, std::vector<double> residuals);

/// A search that goes on from another one's minimum. `linear`: the loss is linear in f, so that
/// linear parameters are eliminated.
Minimum refined(const FitProblem& problem, bool linear, const Minimum& start,
                const MinimiseOptions& options);

}  // namespace hshfit::brdfs
