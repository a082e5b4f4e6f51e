#include <brdfs/fit/minimise.h>

#include <ceres/ceres.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Function = std::function<Equations(std::span<const double>, bool)>;

/// With H = V L V^T (rows and columns scaled to a diagonal of 1) the residuals L^(-1/2) V^T g, and
/// one more that makes up the cost, have the Jacobian L^(1/2) V^T: J^T J = H, J^T r = g.
class CompressedResiduals final : public ceres::CostFunction {
public:
    CompressedResiduals(const Function& equations, std::span<const double> lower,
                        std::span<const double> upper)
        : equations_(equations), count_(lower.size()), lower_(lower), upper_(upper) {
        const std::size_t count = count_;
        set_num_residuals(static_cast<int>(count) + 1);
        mutable_parameter_block_sizes()->push_back(static_cast<int>(count));
    }

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        const bool derivatives = jacobians && jacobians[0];
        const Equations& equations = at(parameters[0]);
        if (!std::isfinite(equations.cost)) return false;
        const auto n = static_cast<Eigen::Index>(count_);
        std::fill_n(residuals, count_ + 1, 0.0);
        residuals[count_] = std::sqrt(2 * equations.cost);
        if (!derivatives) return true;
        Matrix hessian = Eigen::Map<const Matrix>(equations.hessian.data(), n, n);
        Eigen::VectorXd gradient = Eigen::Map<const Eigen::VectorXd>(equations.gradient.data(), n);
        if (!hessian.allFinite() || !gradient.allFinite()) return false;
        // What a bound holds back does not bend the steps of the others: Ceres would cut each step
        // there, and search along it at the price of an evaluation each.
        for (Eigen::Index i = 0; i < n; ++i) {
            const double x = parameters[0][i], pull = gradient(i);
            if ((x > lower_[i] || pull < 0) && (x < upper_[i] || pull > 0)) continue;
            hessian.row(i).setZero(), hessian.col(i).setZero();
            gradient(i) = 0;
        }
        Eigen::VectorXd scale = hessian.diagonal().cwiseMax(0).cwiseSqrt();
        for (Eigen::Index i = 0; i < n; ++i) scale(i) = scale(i) > 0 ? scale(i) : 1;
        hessian.array().colwise() /= scale.array();
        hessian.array().rowwise() /= scale.transpose().array();
        gradient.array() /= scale.array();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
        constexpr double least = 1e-15;
        const Eigen::VectorXd roots = eigen.eigenvalues().cwiseMax(least).cwiseSqrt();
        Eigen::VectorXd top = (eigen.eigenvectors().transpose() * gradient).cwiseQuotient(roots);
        // Rounding alone can make it exceed the cost.
        const double most = 2 * equations.cost, own = top.squaredNorm();
        if (own > most) top *= std::sqrt(most / own);
        Eigen::Map<Eigen::VectorXd>(residuals, n) = top;
        residuals[count_] = std::sqrt(std::max(0.0, most - top.squaredNorm()));
        Eigen::Map<Matrix> jacobian(jacobians[0], n + 1, n);
        jacobian.topRows(n) = roots.asDiagonal() * eigen.eigenvectors().transpose();
        jacobian.topRows(n).array().rowwise() *= scale.transpose().array();
        jacobian.row(n).setZero();
        return true;
    }

private:
    /// Ceres asks for the cost of a trial, and for its derivatives if it is taken, as most are:
    /// both at once, remembered.
    const Equations& at(const double* x) const {
        if (last_.size() != count_ || !std::equal(last_.begin(), last_.end(), x)) {
            last_.assign(x, x + count_);
            remembered_ = equations_({x, count_}, true);
        }
        return remembered_;
    }

    const Function& equations_;
    std::size_t count_;
    std::span<const double> lower_, upper_;
    mutable std::vector<double> last_;
    mutable Equations remembered_;
};

}  // namespace

Minimum minimise(const Function& equations, std::vector<double> start,
                 std::span<const double> lower, std::span<const double> upper,
                 const MinimiseOptions& options) {
    Minimum result;
    result.x = std::move(start);
    if (result.x.empty()) {
        result.cost = equations(result.x, false).cost;
        result.converged = std::isfinite(result.cost);
        result.message = "nothing to iterate on";
        result.evaluations = 1;
        return result;
    }
    for (std::size_t i = 0; i < result.x.size(); ++i)
        result.x[i] = std::clamp(result.x[i], lower[i], upper[i]);
    ceres::Problem problem;
    problem.AddResidualBlock(new CompressedResiduals(equations, lower, upper), nullptr,
                             result.x.data());
    for (std::size_t i = 0; i < result.x.size(); ++i) {
        problem.SetParameterLowerBound(result.x.data(), static_cast<int>(i), lower[i]);
        problem.SetParameterUpperBound(result.x.data(), static_cast<int>(i), upper[i]);
    }
    ceres::Solver::Options ceresOptions;
    ceresOptions.linear_solver_type = ceres::DENSE_QR;
    ceresOptions.max_num_iterations = options.iterations;
    ceresOptions.function_tolerance = options.costTolerance;
    ceresOptions.parameter_tolerance = options.stepTolerance;
    ceresOptions.gradient_tolerance = 1e-14;
    ceresOptions.num_threads = 1;
    ceresOptions.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(ceresOptions, &problem, &summary);
    result.cost = summary.final_cost;
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    result.message = summary.message;
    result.iterations = static_cast<int>(summary.iterations.size()) - 1;
    result.evaluations = summary.num_residual_evaluations + summary.num_jacobian_evaluations;
    return result;
}

}  // namespace hshfit::brdfs
