#pragma once

#include <brdfs/fit/dispersed_problem.h>
#include <brdfs/fit/fit_options.h>
#include <brdfs/fit/fit_result.h>
#include <brdfs/fit/minimise.h>

#include <vector>

namespace hshfit::brdfs {

/// The minimum of a problem from a start on, within the box of the coefficients.
Minimum minimised(const DispersedProblem& problem, std::vector<double> start,
                  const MinimiseOptions& options);

/// Describes a minimum: the parameters of the laws with their errors, correlations and budget, sets
/// that the data do not tell apart, the point for predictions, and the study that was asked for.
void describeDispersed(const DispersedProblem& problem, const Minimum& found,
                       const FitOptions& options, FitResult& result);

}  // namespace hshfit::brdfs
