#include <hshfit/bases/lsosh.h>

#include <hshfit/bases/internal/half_range.h>
#include <hshfit/bases/sh.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>

namespace hshfit::bases {

namespace {

constexpr double smallestSingularValue = 1e-11;  // of the largest; see lsosh.h

/// R_kj = <q_k, Y_j> on the hemisphere, upper triangular. Column by column from the recurrence of
/// the Y_j with mu replaced by the Jacobi matrix of the q_k, whose spectrum lies in [0, 1]: stable.
Eigen::MatrixXd changeOfBasis(int m, int count, const HalfRangeRecurrence& q) {
    const auto beta = [m](int k) {
        const double l = m + k, mm = m;
        return std::sqrt((l - mm) * (l + mm) / ((2 * l - 1) * (2 * l + 1)));
    };
    Eigen::MatrixXd r = Eigen::MatrixXd::Zero(count, count);
    r(0, 0) = std::sqrt(0.5);
    for (int j = 0; j + 1 < count; ++j) {
        for (int k = 0; k <= j + 1; ++k) {
            double value = q.diagonal[k] * r(k, j);
            if (k > 0) value += q.offDiagonal[k] * r(k - 1, j);
            if (k + 1 < count) value += q.offDiagonal[k + 1] * r(k + 1, j);
            if (j > 0) value -= beta(j) * r(k, j - 1);
            r(k, j + 1) = value / beta(j + 1);
        }
    }
    return r;
}

/// The truncated solve of R c = y for one m: kept = left^T y, c = right kept.
struct Solve {
    Eigen::MatrixXd left, right;
};

Solve truncatedSolve(const Eigen::MatrixXd& r) {
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& sigma = svd.singularValues();
    const auto kept = (sigma.array() >= smallestSingularValue * sigma(0)).count();
    return {svd.matrixU().leftCols(kept),
            svd.matrixV().leftCols(kept) * sigma.head(kept).cwiseInverse().asDiagonal()};
}

class Lsosh final : public Basis {
public:
    Lsosh(int order, BasisOptions options)
        : Basis(order, options),
          functions_(makeSh(order, options)),
          recurrences_(halfRangeRecurrences(order)),
          once_(std::make_unique<std::once_flag[]>(static_cast<std::size_t>(order) + 1)),
          solves_(static_cast<std::size_t>(order) + 1) {}

    std::string name() const override { return "lsosh"; }

    void theta(int m, std::span<const Elevation<double>> points, double* out) const override {
        functions_->theta(m, points, out);
    }
    void theta(int m, std::span<const Elevation<float>> points, float* out) const override {
        functions_->theta(m, points, out);
    }
    void tabulate(DirectionBatch directions, Layout layout, double* out) const override {
        functions_->tabulate(directions, layout, out);
    }
    void tabulate(DirectionBatch directions, Layout layout, float* out) const override {
        functions_->tabulate(directions, layout, out);
    }
    void analysisTheta(int m, std::span<const Elevation<double>> points,
                       double* out) const override {
        halfRangeTheta(recurrences_[static_cast<std::size_t>(m)], m, order() - m, points, out);
    }

    void coefficientsFromMoments(const double* moments, int order, double* out) const override {
        forEachBlock(moments, order, [&](int m, const Solve& solve, const Eigen::VectorXd& y) {
            const Eigen::VectorXd c = solve.right * (solve.left.transpose() * y);
            for (int l = std::abs(m); l < order; ++l) out[slotOf(l, m)] = c(l - std::abs(m));
        });
    }

    double capturedEnergy(const double* moments, int order) const override {
        double sum = 0;
        forEachBlock(moments, order, [&](int, const Solve& solve, const Eigen::VectorXd& y) {
            sum += (solve.left.transpose() * y).squaredNorm();
        });
        return sum;
    }

private:
    /// Calls visit(m, solve, moments of m) for |m| < order.
    template <class Visit>
    void forEachBlock(const double* moments, int order, Visit visit) const {
        const std::vector<Solve>& solves = solvesOf(order);
        for (int m = 1 - order; m < order; ++m) {
            const int first = std::abs(m);
            Eigen::VectorXd y(order - first);
            for (int l = first; l < order; ++l) y(l - first) = moments[slotOf(l, m)];
            visit(m, solves[static_cast<std::size_t>(first)], y);
        }
    }

    /// The solves of one truncation order, made when they are first asked for.
    const std::vector<Solve>& solvesOf(int order) const {
        assert(order >= 1 && order <= this->order());
        const auto n = static_cast<std::size_t>(order);
        std::call_once(once_[n], [&] {
            for (int m = 0; m < order; ++m)
                solves_[n].push_back(truncatedSolve(
                    changeOfBasis(m, order - m, recurrences_[static_cast<std::size_t>(m)])));
        });
        return solves_[n];
    }

    std::unique_ptr<Basis> functions_;
    std::vector<HalfRangeRecurrence> recurrences_;
    std::unique_ptr<std::once_flag[]> once_;
    mutable std::vector<std::vector<Solve>> solves_;
};

}  // namespace

std::unique_ptr<Basis> makeLsosh(int order, BasisOptions options) {
    return std::make_unique<Lsosh>(order, options);
}

LsoshGram lsoshGram(int order) {
    const std::vector<HalfRangeRecurrence> recurrences = halfRangeRecurrences(order);
    LsoshGram gram;
    for (int m = 0; m < order; ++m) {
        const Eigen::BDCSVD<Eigen::MatrixXd> svd(
            changeOfBasis(m, order - m, recurrences[static_cast<std::size_t>(m)]));
        const Eigen::VectorXd& sigma = svd.singularValues();
        const double condition = sigma(0) / sigma(sigma.size() - 1);
        gram.condition =
            std::max(gram.condition, condition < 1e15 ? condition * condition
                                                      : std::numeric_limits<double>::infinity());
        const auto kept = (sigma.array() >= smallestSingularValue * sigma(0)).count();
        gram.kept += static_cast<int>(m == 0 ? kept : 2 * kept);
    }
    return gram;
}

}  // namespace hshfit::bases
