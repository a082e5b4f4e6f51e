#pragma once

#include <brdfs/fit/normal_equations.h>

#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

/// The covariance of the parameters that are not fixed, at a minimum.
struct Covariance {
    std::vector<double> variance;      ///< [n]; negative: fixed or not determined
    std::vector<double> correlations;  ///< [n * n]; 0 where there is no variance
    /// [n * n]; 0 for what is fixed. Of undetermined parameters too, without the directions that
    /// have no effect.
    std::vector<double> whole;
    /// Sets of indices that act together along one direction without any effect.
    std::vector<std::vector<std::size_t>> ambiguous;
};

/// hessian^-1 [n * n] over what is not fixed, 0 elsewhere. Directions in which the matrix, scaled
/// to a diagonal of 1, is below 1e-9 are left out.
std::vector<double> inverseOf(const Equations& equations, const std::vector<bool>& fixed);

/// hessian^-1 spread hessian^-1, and what rounding of the cost (which is 1/2 where f = 0) leaves
/// open: without noise all there is. Directions that inverseOf leaves out are reported.
Covariance covarianceOf(const Equations& equations, const std::vector<bool>& fixed);

}  // namespace hshfit::brdfs
