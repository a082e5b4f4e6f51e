#pragma once

#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/normal_equations.h>

#include <Eigen/Core>

#include <cstddef>
#include <functional>

namespace hshfit::brdfs {

/// Samples of one scan whose errors may be correlated over angles.
inline constexpr std::size_t mostCorrelated = 30000;

/// J^T W C W J of values whose errors have the covariance C that SigmaCorrelation states, with the
/// weights W = 1 / sigma^2: the spread of the gradient of a fit by independent weights. `addRow`
/// adds value v's root(w) times its derivatives by the n parameters to a row of zeros. Time grows
/// with the square of the samples of a scan.
Eigen::MatrixXd correlatedSpread(
    const FitSamples& samples, std::size_t n,
    const std::function<void(std::size_t v, Eigen::Ref<Eigen::RowVectorXd> row)>& addRow);

/// The spread by rows that are made already. `shapes`: WeightedRows::place.
Eigen::MatrixXd correlatedSpread(const FitSamples& samples, const WeightedRows& rows, std::size_t n,
                                 std::size_t shapes);

}  // namespace hshfit::brdfs
