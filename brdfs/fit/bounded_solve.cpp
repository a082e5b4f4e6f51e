#include <brdfs/fit/normal_equations.h>

#include <hshfit/error.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The unconstrained minimum over the variables in `free`, the others as they are in x.
Eigen::VectorXd solveFree(const RowMatrix& a, const Eigen::VectorXd& b, const Eigen::VectorXd& x,
                          const std::vector<Eigen::Index>& free) {
    const auto n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd part(n, n);
    Eigen::VectorXd right(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        right(i) = b(free[i]) - a.row(free[i]).dot(x);
        for (Eigen::Index j = 0; j < n; ++j) {
            part(i, j) = a(free[i], free[j]);
            right(i) += part(i, j) * x(free[j]);
        }
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-14);
    solver.compute(part);
    return solver.solve(right);
}

}  // namespace

std::vector<double> solveBounded(std::span<const double> a, std::span<const double> b,
                                 std::span<const double> lower, std::span<const double> upper) {
    const auto n = static_cast<Eigen::Index>(b.size());
    if (n == 0) return {};
    // Columns of norm 1.
    RowMatrix scaled = Eigen::Map<const RowMatrix>(a.data(), n, n);
    Eigen::VectorXd norm = scaled.diagonal().cwiseMax(0).cwiseSqrt();
    Eigen::VectorXd right(n), low(n), high(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double s = norm(i) > 0 ? norm(i) : 1;
        scaled.row(i) /= s, scaled.col(i) /= s;
        right(i) = b[i] / s, low(i) = lower[i] * s, high(i) = upper[i] * s;
    }
    Eigen::VectorXd x = low;
    std::vector<char> isFree(static_cast<std::size_t>(n), 0);
    const double tolerance =
        1e-14 * std::max(right.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    constexpr double rounding = 1e-8;  // gains that a variable sent back to its bound may leave
    for (Eigen::Index step = 0;; ++step) {
        const Eigen::VectorXd gradient = right - scaled * x;
        Eigen::Index enter = -1;
        double most = tolerance;
        for (Eigen::Index i = 0; i < n; ++i) {
            if (isFree[i] || norm(i) == 0 || low(i) == high(i)) continue;
            const double gain = x(i) <= low(i) ? gradient(i) : -gradient(i);
            if (gain > most) most = gain, enter = i;
        }
        if (enter < 0) break;
        if (step == 20 * n + 20) {
            if (most <= rounding * right.cwiseAbs().maxCoeff()) break;
            throw NumericError(
                "the linear parameters were not found within their bounds: the active set cycles");
        }
        isFree[enter] = 1;
        for (int inner = 0; inner <= n; ++inner) {
            std::vector<Eigen::Index> free;
            for (Eigen::Index i = 0; i < n; ++i)
                if (isFree[i]) free.push_back(i);
            if (free.empty()) break;
            const Eigen::VectorXd target = solveFree(scaled, right, x, free);
            double share = 1;
            Eigen::Index leave = -1;
            for (std::size_t k = 0; k < free.size(); ++k) {
                const Eigen::Index i = free[k];
                const double to = target(static_cast<Eigen::Index>(k));
                const double bound = to < low(i) ? low(i) : to > high(i) ? high(i) : to;
                if (bound == to) continue;
                const double part = to == x(i) ? 0 : (bound - x(i)) / (to - x(i));
                if (part < share) share = part, leave = i;
            }
            for (std::size_t k = 0; k < free.size(); ++k)
                x(free[k]) += share * (target(static_cast<Eigen::Index>(k)) - x(free[k]));
            if (leave < 0) break;
            x(leave) = std::abs(x(leave) - low(leave)) <= std::abs(x(leave) - high(leave))
                           ? low(leave)
                           : high(leave);
            isFree[leave] = 0;
        }
    }
    std::vector<double> result(b.size());
    for (Eigen::Index i = 0; i < n; ++i) {
        const double value = x(i) / (norm(i) > 0 ? norm(i) : 1);
        result[i] = x(i) <= low(i)    ? lower[i]
                    : x(i) >= high(i) ? upper[i]
                                      : std::clamp(value, lower[i], upper[i]);
    }
    return result;
}

}  // namespace hshfit::brdfs
