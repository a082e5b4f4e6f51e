#pragma once

#include <brdfs/fit/fit_result.h>
#include <brdfs/fit/normal_equations.h>

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <vector>

namespace hshfit::brdfs {

/// Change of the samples' values by a contribution, per unit of its quantity: [channel * size() +
/// k]. `modelAt`: values of the fit at turned samples. Angles act by central differences of these,
/// times the cosines (cosineRatios).
std::vector<double> shiftOf(
    const Contribution& contribution, const FitSamples& samples, Cosines cosines,
    const std::function<std::vector<double>(const FitSamples& turned)>& modelAt);

/// J^T W times a shift of the values, in the loss: what it adds to the gradient of x [n]. Of
/// whitened rows the shift is FitProblem::weighted.
Eigen::VectorXd pullOf(const WeightedRows& rows, const std::vector<double>& shift,
                       const FitSamples& samples, Loss::Kind loss, std::size_t n,
                       std::size_t shapes);

/// Changes by each contribution, per unit of its quantity, by the normal equations of the fit:
/// (J^T W J)^-1 J^T W shift. [contribution][parameter or coefficient].
struct CommonChanges {
    std::vector<std::vector<double>> parameters;
    std::vector<std::vector<double>> coefficients;  ///< of FittedPoint; empty: the parameters
};

/// Adds contributions to standard errors, correlations and covariance of a fit and states the
/// budget. `degrees`: of the parameters' standard errors without them; infinite: known.
void addBudget(const std::vector<Contribution>& contributions, const CommonChanges& changes,
               const std::vector<double>& degrees, FitResult& result);

}  // namespace hshfit::brdfs
