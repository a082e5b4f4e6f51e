#include <brdfs/fit/minimise.h>

#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/stop_request.h>

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// With H = V L V^T (rows and columns scaled to a diagonal of 1) the residuals L^(-1/2) V^T g, and
/// one more that makes up the cost, have the Jacobian L^(1/2) V^T: J^T J = H, J^T r = g.
class CompressedResiduals final : public ceres::CostFunction {
public:
    CompressedResiduals(const SumOfSquares& equations, std::span<const double> lower,
                        std::span<const double> upper)
        : equations_(equations), count_(lower.size()), lower_(lower), upper_(upper) {
        const std::size_t count = count_;
        set_num_residuals(static_cast<int>(count) + 1);
        mutable_parameter_block_sizes()->push_back(static_cast<int>(count));
    }

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        const bool derivatives = jacobians && jacobians[0];
        const Equations& equations = at(parameters[0], derivatives);
        if (!std::isfinite(equations.cost)) return false;
        const auto n = static_cast<Eigen::Index>(count_);
        std::fill_n(residuals, count_ + 1, 0.0);
        residuals[count_] = std::sqrt(2 * equations.cost);
        if (!derivatives) return true;
        RowMatrix hessian = Eigen::Map<const RowMatrix>(equations.hessian.data(), n, n);
        Eigen::VectorXd gradient = Eigen::Map<const Eigen::VectorXd>(equations.gradient.data(), n);
        if (!hessian.allFinite() || !gradient.allFinite()) return false;
        // A parameter held back by its bound leaves the steps of the others alone: Ceres would cut
        // each step there, and search along it at the price of an evaluation each.
        for (Eigen::Index i = 0; i < n; ++i) {
            const double x = parameters[0][i], pull = gradient(i);
            if ((!isAt(lower_[i], x) || pull < 0) && (!isAt(upper_[i], x) || pull > 0)) continue;
            hessian.row(i).setZero(), hessian.col(i).setZero();
            gradient(i) = 0;
        }
        Eigen::VectorXd scale = hessian.diagonal().cwiseMax(0).cwiseSqrt();
        for (Eigen::Index i = 0; i < n; ++i) scale(i) = scale(i) > 0 ? scale(i) : 1;
        hessian.array().colwise() /= scale.array();
        hessian.array().rowwise() /= scale.transpose().array();
        gradient.array() /= scale.array();
        pull_ =
            equations.cost > 0 ? gradient.cwiseAbs().maxCoeff() / std::sqrt(2 * equations.cost) : 0;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{Eigen::MatrixXd(hessian)};
        constexpr double least = 1e-15;
        const Eigen::VectorXd roots = eigen.eigenvalues().cwiseMax(least).cwiseSqrt();
        Eigen::VectorXd top = (eigen.eigenvectors().transpose() * gradient).cwiseQuotient(roots);
        // Rounding alone can make it exceed the cost.
        const double most = 2 * equations.cost, own = top.squaredNorm();
        if (own > most) top *= std::sqrt(most / own);
        Eigen::Map<Eigen::VectorXd>(residuals, n) = top;
        residuals[count_] = std::sqrt(std::max(0.0, most - top.squaredNorm()));
        Eigen::Map<RowMatrix> jacobian(jacobians[0], n + 1, n);
        jacobian.topRows(n) = roots.asDiagonal() * eigen.eigenvectors().transpose();
        jacobian.topRows(n).array().rowwise() *= scale.transpose().array();
        jacobian.row(n).setZero();
        return true;
    }

    /// The largest component of the last gradient that no bound holds.
    double pull() const { return pull_; }

private:
    /// Steps that are cut at a bound end within rounding of it.
    static bool isAt(double bound, double x) {
        constexpr double rounding = 1e-12;
        return std::abs(x - bound) <= rounding * std::max(1.0, std::abs(bound));
    }
    const Equations& at(const double* x, bool derivatives) const {
        if (last_.size() != count_ || !std::equal(last_.begin(), last_.end(), x) ||
            (derivatives && remembered_.hessian.empty())) {
            last_.assign(x, x + count_);
            remembered_ = equations_({x, count_}, derivatives);
        }
        return remembered_;
    }

    const SumOfSquares& equations_;
    std::size_t count_;
    std::span<const double> lower_, upper_;
    mutable double pull_ = 0;
    mutable std::vector<double> last_;
    mutable Equations remembered_;
};

/// Ceres asks for the cost of a trial, and for its derivatives if it is taken, as most are: both at
/// once.
SumOfSquares always(const SumOfSquares& equations) {
    return [&equations](std::span<const double> x, bool) { return equations(x, true); };
}

constexpr int gaussNewtonIterations = 10;
/// Relative fall of the cost, and largest component of the gradient in units of the root of its
/// curvature and of the cost, in which a search counts as settled.
constexpr double settledTolerance = 1e-7, settledPull = 1e-3;
/// Points after which a search makes second derivatives anew, for 2 n gradients. In the level
/// valleys of SGD, 2 takes 0.6 of the time that 1 does; with more, OpenPBR without noise ends in a
/// minimum at a bound.
constexpr int renewal = 2;
/// Points after which second derivatives by fewer samples are made anew: more often, they cost more
/// time than they save.
constexpr int renewalOfFewer = 4;

/// Equations whose matrix has the second derivatives: differences of the gradient, with
/// eigenvalues made positive. The part of it that Gauss-Newton's matrix lacks changes slowly along
/// a search (Dennis, Gay & Welsch 1981, 10.1145/355958.355965): it is made anew at every
/// `renewed`th point.
class Newton {
public:
    /// `fewer`: a sum over part of the samples, whose gradients stand for the gradients of all; or
    /// null.
    Newton(const SumOfSquares& equations, const SumOfSquares* fewer, std::span<const double> lower,
           std::span<const double> upper, int renewed)
        : equations_(equations), fewer_(fewer), lower_(lower), upper_(upper), renewed_(renewed) {}

    Equations at(std::span<const double> x, bool derivatives) const {
        Equations result = equations_(x, derivatives);
        ++evaluations_;
        if (!derivatives || !std::isfinite(result.cost)) return result;
        const auto n = static_cast<Eigen::Index>(x.size());
        Eigen::Map<RowMatrix> given(result.hessian.data(), n, n);
        if (age_++ % renewed_ != 0 && added_.rows() == n) {
            given = positive(given + added_, given);
            return result;
        }
        const SumOfSquares& source = fewer_ ? *fewer_ : equations_;
        const Equations own = fewer_ ? source(x, true) : Equations();
        const RowMatrix model =
            fewer_ ? RowMatrix(Eigen::Map<const RowMatrix>(own.hessian.data(), n, n))
                   : RowMatrix(given);
        const double cost = fewer_ ? own.cost : result.cost;
        RowMatrix hessian = model;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            const double curvature = model(row, row);
            if (!(curvature > 0)) {
                hessian.row(row).setZero();
                continue;
            }
            const double step = std::clamp(1e-3 * std::sqrt(2 * cost / curvature), 1e-7, 1e-2);
            const auto gradientAt = [&](double moved) {
                std::vector<double> point(x.begin(), x.end());
                point[i] = moved;
                if (!fewer_) ++evaluations_;
                return source(point, true).gradient;
            };
            const double above = std::min(x[i] + step, upper_[i]),
                         below = std::max(x[i] - step, lower_[i]);
            const std::vector<double> high = gradientAt(above), low = gradientAt(below);
            for (Eigen::Index j = 0; j < n; ++j) {
                const auto k = static_cast<std::size_t>(j);
                hessian(row, j) = (high[k] - low[k]) / (above - below);
            }
        }
        for (Eigen::Index i = 0; i < n; ++i)
            if (!(model(i, i) > 0)) hessian.col(i).setZero();
        hessian = (0.5 * (hessian + hessian.transpose())).eval();
        if (!hessian.allFinite()) return result;
        added_ = hessian - model;
        given = positive(given + added_, given);
        return result;
    }
    int evaluations() const { return evaluations_; }

private:
    /// `hessian` with eigenvalues, on the scale of `model`, of their size and no less than 1e-9.
    static RowMatrix positive(const RowMatrix& hessian, const RowMatrix& model) {
        Eigen::VectorXd scale = model.diagonal().cwiseMax(0).cwiseSqrt();
        for (double& s : scale) s = s > 0 ? s : 1;
        RowMatrix scaled = hessian;
        scaled.array().colwise() /= scale.array();
        scaled.array().rowwise() /= scale.transpose().array();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{Eigen::MatrixXd(scaled)};
        constexpr double least = 1e-9;
        RowMatrix result = eigen.eigenvectors() *
                           eigen.eigenvalues().cwiseAbs().cwiseMax(least).asDiagonal() *
                           eigen.eigenvectors().transpose();
        result.array().colwise() *= scale.array();
        result.array().rowwise() *= scale.transpose().array();
        return result;
    }

    const SumOfSquares& equations_;
    const SumOfSquares* fewer_;
    std::span<const double> lower_, upper_;
    int renewed_;
    mutable int evaluations_ = 0, age_ = 0;
    mutable RowMatrix added_;
};

/// Ends a search whose cost has fallen by less than `settledTolerance` of itself in `window`
/// iterations, in a valley that is all but level: if the gradient is as small.
class Settled final : public ceres::IterationCallback {
public:
    Settled(std::function<double()> pull, const TimeLimit& limit)
        : pull_(std::move(pull)), limit_(limit) {}
    bool endedByTime() const { return endedByTime_; }
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
        constexpr std::size_t window = 10;
        if (stopIsRequested()) return ceres::SOLVER_ABORT;
        endedByTime_ = limit_.isOver();
        if (endedByTime_) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
        costs_.push_back(summary.cost);
        if (costs_.size() <= window) return ceres::SOLVER_CONTINUE;
        const double fallen = costs_[costs_.size() - 1 - window] - summary.cost;
        if (fallen > settledTolerance * summary.cost || pull_() > settledPull)
            return ceres::SOLVER_CONTINUE;
        return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }

private:
    std::function<double()> pull_;
    const TimeLimit& limit_;
    bool endedByTime_ = false;
    std::vector<double> costs_;
};

/// Goes on from result.x.
void solve(const SumOfSquares& equations, std::span<const double> lower,
           std::span<const double> upper, const MinimiseOptions& options, int iterations,
           Minimum& result) {
    ceres::Problem problem;
    auto* residuals = new CompressedResiduals(equations, lower, upper);
    problem.AddResidualBlock(residuals, nullptr, result.x.data());
    Settled settled([&] { return residuals->pull(); }, options.limit);
    for (std::size_t i = 0; i < result.x.size(); ++i) {
        problem.SetParameterLowerBound(result.x.data(), static_cast<int>(i), lower[i]);
        problem.SetParameterUpperBound(result.x.data(), static_cast<int>(i), upper[i]);
    }
    ceres::Solver::Options ceresOptions;
    ceresOptions.linear_solver_type = ceres::DENSE_QR;
    ceresOptions.max_num_iterations = iterations;
    ceresOptions.function_tolerance = options.costTolerance;
    ceresOptions.parameter_tolerance = options.stepTolerance;
    ceresOptions.gradient_tolerance = 1e-14;
    ceresOptions.num_threads = 1;
    // Where a step meets a bound, Ceres tries shorter ones, each for the price of a whole step.
    ceresOptions.max_num_line_search_step_size_iterations = 3;
    ceresOptions.logging_type = ceres::SILENT;
    ceresOptions.callbacks.push_back(&settled);
    ceres::Solver::Summary summary;
    ceres::Solve(ceresOptions, &problem, &summary);
    stopIfRequested();
    result.cost = summary.final_cost;
    const bool ended = settled.endedByTime();
    const bool level = summary.termination_type == ceres::USER_SUCCESS && !ended;
    result.converged = level || summary.termination_type == ceres::CONVERGENCE;
    result.iterations += static_cast<int>(summary.iterations.size()) - 1;
    result.evaluations += summary.num_residual_evaluations + summary.num_jacobian_evaluations;
    if (ended)
        result.message = "stopped at the end of the time";
    else if (level)
        result.message = "The cost fell by less than 1e-7 of itself in 10 iterations.";
    else if (summary.termination_type == ceres::NO_CONVERGENCE)
        result.message = fmt::format("the cost still falls after {} iterations", result.iterations);
    else if (summary.termination_type == ceres::FAILURE)
        result.message = "no step to finite values was found";
    else
        result.message = summary.message;
}

}  // namespace

Minimum minimise(const SumOfSquares& equations, std::vector<double> start,
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
    int left = options.iterations;
    const bool known = options.curvature && options.fewer;
    if (!known) {
        const int first = options.curvature ? std::min(left, gaussNewtonIterations) : left;
        solve(always(equations), lower, upper, options, first, result);
        left -= first;
        if (result.converged || left == 0 || options.limit.isOver()) return result;
    }
    // Large residuals: what Gauss-Newton leaves out of the matrix rules its (linear) convergence.
    const Newton newton(equations, options.fewer, lower, upper, known ? renewalOfFewer : renewal);
    const SumOfSquares withCurvature = [&](std::span<const double> x, bool derivatives) {
        return newton.at(x, derivatives);
    };
    solve(withCurvature, lower, upper, options, left, result);
    result.evaluations += newton.evaluations();
    return result;
}

}  // namespace hshfit::brdfs
