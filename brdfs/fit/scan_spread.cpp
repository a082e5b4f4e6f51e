#include <brdfs/fit/scan_spread.h>

#include <brdfs/fit/dense.h>
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

double satterthwaite(double trace, double squares) {
    // Where one scan decides alone, rounding is all there is.
    constexpr double least = 0.1;
    const double degrees = trace > 0 && squares > 0 ? trace * trace / squares : 0;
    return degrees > least ? degrees : 0;
}

}  // namespace

// For a combination c of the parameters (a row of `of`), M = L L^T the inverse, A and g the matrix
// and gradient of a scan, q = L^T A L and b = L^T c. The variance of c is estimated from a term
// v^T L^T g of each scan, v = (1 - q)^-1 b. The covariance of these terms is diag(v^T q v) - Y^T Y,
// where a scan has the column y = q v of Y.
std::vector<double> scanDegrees(const std::vector<ScanSums>& scans, const Eigen::MatrixXd& inverse,
                                const Eigen::MatrixXd& of) {
    const Eigen::MatrixXd root = rootOf(inverse);
    const Eigen::MatrixXd b = (of * root).transpose();
    const Eigen::Index count = b.cols();
    struct Sums {
        double trace = 0, squares = 0;
        Eigen::MatrixXd outer;
    };
    std::vector<Sums> sums(static_cast<std::size_t>(count),
                           {0, 0, Eigen::MatrixXd::Zero(b.rows(), b.rows())});
    for (const ScanSums& scan : scans) {
        const Eigen::MatrixXd part = root.transpose() * scan.matrix * root;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(part);
        const Eigen::VectorXd shares = eigen.eigenvalues().cwiseMax(0);
        const Eigen::VectorXd freedom = (1 - shares.array()).max(leastFreedom);
        const Eigen::MatrixXd inner = eigen.eigenvectors().transpose() * b;
        for (Eigen::Index i = 0; i < count; ++i) {
            const Eigen::VectorXd v = inner.col(i).cwiseQuotient(freedom);
            const Eigen::VectorXd y = eigen.eigenvectors() * shares.cwiseProduct(v);
            const double own = v.dot(shares.cwiseProduct(v)), less = y.squaredNorm();
            Sums& sum = sums[static_cast<std::size_t>(i)];
            sum.trace += own - less;
            sum.squares += own * (own - 2 * less);
            sum.outer.noalias() += y * y.transpose();
        }
    }
    std::vector<double> degrees;
    for (const Sums& sum : sums) {
        const double squares = sum.squares + sum.outer.squaredNorm();
        degrees.push_back(satterthwaite(sum.trace, squares));
    }
    return degrees;
}

// As above with q = u u^T of a value, u = L^T a and leverage u^T u: u^T v = u^T b / (1 - u^T u).
std::vector<double> valueDegrees(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& inverse,
                                 const Eigen::MatrixXd& of) {
    const Eigen::MatrixXd root = rootOf(inverse), u = rows * root;
    const Eigen::ArrayXd leverage = u.rowwise().squaredNorm();
    const Eigen::MatrixXd along = u * (of * root).transpose();
    std::vector<double> degrees;
    for (Eigen::Index i = 0; i < along.cols(); ++i) {
        const Eigen::ArrayXd own =
            (along.col(i).array() / (1 - leverage).max(leastFreedom)).square();
        const Eigen::MatrixXd outer = u.transpose() * own.matrix().asDiagonal() * u;
        const double trace = (own * (1 - leverage)).sum();
        const double squares = (own.square() * (1 - 2 * leverage)).sum() + outer.squaredNorm();
        degrees.push_back(satterthwaite(trace, squares));
    }
    return degrees;
}

std::vector<double> VarianceFreedom::degrees(const Eigen::MatrixXd& of) const {
    const Eigen::MatrixXd own = of * slope_.asDiagonal();
    return scans_.empty() ? valueDegrees(rows_, inverse_, own) : scanDegrees(scans_, inverse_, own);
}

void requireScans(std::size_t scans, std::size_t parameters, bool stated) {
    if (scans > parameters || stated) return;
    throw NumericError(
        fmt::format("{} scans cannot give errors of {} parameters; expected more "
                    "scans than parameters, or the samples' uncertainties",
                    scans, parameters));
}

Eigen::MatrixXd scanSpread(const std::vector<ScanSums>& scans, const Eigen::MatrixXd& inverse) {
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
