#pragma once

#include <Eigen/Core>

#include <vector>

namespace hshfit::brdfs {

/// J^T W J and J^T W r of the values of one scan.
struct ScanSums {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd gradient;
};

/// (S - 1) / S times the sum over S scans of g g^T, g the gradient of a scan as it would be if the
/// scan had not been fitted (CR3: Bell & McCaffrey 2002). `inverse`: of the sum of the matrices
/// [n * n], 0 for what is held. Throws NumericError for no more scans than `parameters`.
Eigen::MatrixXd scanSpread(const std::vector<ScanSums>& scans, const Eigen::MatrixXd& inverse,
                           std::size_t parameters);

}  // namespace hshfit::brdfs
