#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <utility>
#include <vector>

namespace hshfit::brdfs {

/// J^T W J and J^T W r of the values of one scan.
struct ScanSums {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd gradient;
};

/// Throws NumericError where there are no more scans than parameters of one channel, and
/// uncertainties, which could give errors in their place, are not `stated`.
void requireScans(std::size_t scans, std::size_t parameters, bool stated);

/// (S - 1) / S times the sum over S scans of g g^T, g the gradient of a scan as it would be if the
/// scan had not been fitted (CR3: Bell & McCaffrey 2002). `inverse`: of the sum of the matrices
/// [n * n], 0 for what is held. Of no use for no more scans than parameters of one channel.
Eigen::MatrixXd scanSpread(const std::vector<ScanSums>& scans, const Eigen::MatrixXd& inverse);

/// Degrees of freedom of the variances that scanSpread gives to combinations of the parameters, the
/// rows of `of`: Satterthwaite's, of the chi-square with the variance's mean and variance if
/// errors are independent with equal weighted variance (Bell & McCaffrey 2002; Pustejovsky & Tipton
/// 2018, 10.1080/07350015.2016.1247004). About S if all S scans determine a combination alike,
/// fewer if some do; intervals are by Student's distribution. 0 where the variance is 0.
std::vector<double> scanDegrees(const std::vector<ScanSums>& scans, const Eigen::MatrixXd& inverse,
                                const Eigen::MatrixXd& of);

/// The same where each value is a scan of its own (HC3). `rows`: root(w) times the derivatives of
/// each value by the parameters [value, parameter].
std::vector<double> valueDegrees(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& inverse,
                                 const Eigen::MatrixXd& of);

/// Above this number of values, their degrees of freedom hardly matter, and take long.
inline constexpr std::size_t mostFreedomValues = 20'000;

/// Degrees of freedom of the variances of a fit, for combinations that are known later.
class VarianceFreedom {
public:
    /// `slope`: of the coefficients by the parameters in which the others are.
    VarianceFreedom(std::vector<ScanSums> scans, Eigen::MatrixXd inverse, Eigen::VectorXd slope)
        : scans_(std::move(scans)), inverse_(std::move(inverse)), slope_(std::move(slope)) {}
    VarianceFreedom(Eigen::MatrixXd rows, Eigen::MatrixXd inverse, Eigen::VectorXd slope)
        : rows_(std::move(rows)), inverse_(std::move(inverse)), slope_(std::move(slope)) {}

    Eigen::Index count() const { return slope_.size(); }
    /// scanSpread of the scans.
    Eigen::MatrixXd spread() const { return scanSpread(scans_, inverse_); }
    std::size_t scanCount() const { return scans_.size(); }
    /// Degrees of freedom of combinations of the coefficients, rows of `of`; 0 where the variance
    /// is 0.
    std::vector<double> degrees(const Eigen::MatrixXd& of) const;

private:
    std::vector<ScanSums> scans_;  ///< empty: values that stand each for itself
    Eigen::MatrixXd rows_, inverse_;
    Eigen::VectorXd slope_;
};

}  // namespace hshfit::brdfs
