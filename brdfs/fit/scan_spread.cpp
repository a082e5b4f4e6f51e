#include <brdfs/fit/scan_spread.h>

#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <fmt/format.h>

namespace hshfit::brdfs {
namespace {

/// L with L L^T = inverse, from the eigenvalues of the matrix scaled to a diagonal of 1.
Eigen::MatrixXd rootOf(const Eigen::MatrixXd& inverse) {
    Eigen::VectorXd scale = inverse.diagonal().cwiseMax(0).cwiseSqrt();
    Eigen::MatrixXd scaled = inverse;
    for (Eigen::Index i = 0; i < scale.size(); ++i) {
        const double s = scale(i) > 0 ? 1 / scale(i) : 0;
        scaled.row(i) *= s, scaled.col(i) *= s;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    return scale.asDiagonal() * eigen.eigenvectors() *
           eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace

Eigen::MatrixXd scanSpread(const std::vector<ScanSums>& scans, const Eigen::MatrixXd& inverse,
                           std::size_t parameters) {
    if (scans.size() <= parameters)
        throw NumericError(fmt::format(
            "{} scans cannot give errors of {} parameters; expected more scans than parameters",
            scans.size(), parameters));
    // Rounding leaves some of 1 - leverage where a scan alone decides.
    constexpr double leastFreedom = 1e-6;
    const Eigen::MatrixXd root = rootOf(inverse);
    // With M = L L^T: (1 - A M)^-1 b = b + A L (1 - L^T A L)^-1 L^T b.
    Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(inverse.rows(), inverse.cols());
    for (const ScanSums& scan : scans) {
        const Eigen::MatrixXd own = root.transpose() * scan.matrix * root;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(own);
        const Eigen::VectorXd freedom = (1 - eigen.eigenvalues().array()).max(leastFreedom);
        const Eigen::VectorXd inner =
            eigen.eigenvectors() * freedom.cwiseInverse().asDiagonal() *
            (eigen.eigenvectors().transpose() * (root.transpose() * scan.gradient));
        const Eigen::VectorXd left = scan.gradient + scan.matrix * (root * inner);
        spread += left * left.transpose();
    }
    const double count = static_cast<double>(scans.size());
    return spread * ((count - 1) / count);
}

}  // namespace hshfit::brdfs
