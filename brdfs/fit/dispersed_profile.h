#pragma once

#include <brdfs/fit/dispersed_problem.h>
#include <brdfs/fit/uncertainty.h>

#include <vector>

namespace hshfit::brdfs {

/// Adds profiles (profileOf) of the parameters that a report states of the laws, such as A and B of
/// cauchy, to a study that has their normal errors. The parameter takes the place of the
/// coefficient that decides it most, which follows from it and the others; a value for which that
/// coefficient would leave its bounds is not feasible. `x`: the coefficients at the minimum;
/// `fixed`: the coefficients that bounds hold.
void addProfiles(const DispersedProblem& problem, const std::vector<double>& x,
                 const std::vector<bool>& fixed, const UncertaintyOptions& options,
                 Uncertainty& study);

}  // namespace hshfit::brdfs
