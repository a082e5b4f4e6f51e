#pragma once

#include <hshfit/accuracy/pair_sample.h>
#include <hshfit/linear_algebra/decompositions.h>

namespace hshfit::material_library {

/// Fixed pairs with weights that sum to 1, the terms at each, and the metric that they give:
///     |d|^2 = c^T A c,   A = X^T W X + ridge,   d = L^T c,   A = L L^T,
/// the weighted mean of squares of a sum of terms with the numbers c.
struct LogSamples {
    LogSamples();

    PairSample pairs;
    Eigen::VectorXd weights;
    linear_algebra::RowMajor terms;  ///< X: [pair][term]
    Eigen::MatrixXd metric;          ///< A
    Eigen::MatrixXd lower;           ///< L

    /// A^-1 b, column by column.
    Eigen::MatrixXd solve(Eigen::MatrixXd right) const;
};

}  // namespace hshfit::material_library
