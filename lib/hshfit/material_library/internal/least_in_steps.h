#pragma once

#include <Eigen/Core>

namespace hshfit::material_library {

/// Whole numbers q, |q_k| <= most_k, with a small q^T gram q - 2 q^T right; `gram` is positive
/// definite, `most` whole.
///
/// Numbers whose best real values are out of bounds stay at the bound, and the others make up for
/// them. These are rounded one after another, the last first, to one of the two nearest to the best
/// that is left to them (Babai 1986, "On Lovasz' lattice reduction and the nearest lattice point
/// problem"); the 32 best beginnings are kept. At the end no change of one number makes it less.
Eigen::VectorXd leastInSteps(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                             const Eigen::VectorXd& most);

}  // namespace hshfit::material_library
