#pragma once

#include <brdfs/fit/fit_result.h>

namespace hshfit::brdfs {

/// Sets loss, AIC and BIC of a fit, whose values and parameters are set, from the weighted sum of
/// squares and the sum of weights. `stated`: weights are 1/sigma^2.
void addStatistics(double squares, double weights, bool stated, FitResult& result);

}  // namespace hshfit::brdfs
