#pragma once

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/fit_result.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// Sets loss, AIC and BIC of a fit, whose values and parameters are set, from the weighted sum of
/// squares and the sum of weights. `stated`: weights are 1/sigma^2.
void addStatistics(double squares, double weights, bool stated, FitResult& result);

/// Throws NumericError where a fit of `model` has fewer values than free parameters.
void requireValues(const std::string& model, std::size_t values, std::size_t parameters);

/// Sets standard errors, correlations and the sets that the data do not tell apart of a fit whose
/// parameters are set. `slope`: of the parameters' values by x.
void stateErrors(const Covariance& covariance, const std::vector<double>& slope, FitResult& result);

/// Sets of indices as the labels of the parameters.
std::vector<std::vector<std::string>> labelsOf(const std::vector<std::vector<std::size_t>>& sets,
                                               const std::vector<FittedParameter>& parameters);

/// The covariance of the parameters' values, from the covariance of x [n * n].
std::vector<double> covarianceOfValues(const Covariance& covariance,
                                       const std::vector<double>& slope);

}  // namespace hshfit::brdfs
