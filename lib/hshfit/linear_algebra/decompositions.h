#pragma once

// Eigen's decompositions that the rooms use, compiled once in decompositions.cpp. An object file
// that instantiates one of them itself takes 10 to 35 seconds to compile. A decomposition that is
// missing here still works; it is then compiled where it is used, and so is one of an expression:
// give it an Eigen::MatrixXd.

#include <Eigen/Dense>

namespace hshfit::linear_algebra {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace hshfit::linear_algebra

extern template class Eigen::BDCSVD<Eigen::MatrixXd>;
extern template class Eigen::JacobiSVD<Eigen::MatrixXd>;
extern template class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;
extern template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>&
Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute(const Eigen::EigenBase<Eigen::MatrixXd>&,
                                                        int);
extern template class Eigen::HouseholderQR<hshfit::linear_algebra::RowMajor>;
extern template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
extern template class Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;
