#include <hshfit/representation/constraints/constraints_cone.h>
#include <hshfit/representation/factoring/internal/factoring_steps.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline factoring {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Index = Eigen::Index;

/// Hierarchical alternating least squares: one column of the left part, then one row of the right,
/// each the exact minimum with all others held.
class NonNegativeSearch {
public:
    NonNegativeSearch(const WeightedRows& rows, const Basis& basis, std::size_t rank, bool even)
        : cone_(basis, even),
          roughCone_(basis, even, /*sure=*/false),
          gram_(basis),
          weights_(Eigen::Map<const Eigen::VectorXd>(rows.solidAngles.data(),
                                                     static_cast<Index>(rows.rows))),
          rest_(Eigen::Map<const Matrix>(rows.coefficients.data(), static_cast<Index>(rows.rows),
                                         static_cast<Index>(rows.slots))),
          left_(Matrix::Zero(rest_.rows(), static_cast<Index>(rank))),
          right_(Matrix::Zero(static_cast<Index>(rank), rest_.cols())) {}

    RowFactors search(int mostSweeps) {
        constexpr double enough = 1e-4, nothing = 1e-24;
        const double whole = error();
        for (Index r = 0; r < right_.rows(); ++r) seed(r);
        bool settled = false;
        double before = error();
        for (int sweep = 0; sweep < mostSweeps && !settled; ++sweep) {
            for (Index r = 0; r < right_.rows(); ++r) improve(r);
            const double now = error();
            settled = before - now <= enough * before || now <= nothing * whole;
            before = now;
        }
        sure_ = true;
        for (Index r = 0; r < right_.rows(); ++r) improve(r);
        RowFactors factors{
            .rank = static_cast<std::size_t>(right_.rows()), .left = {}, .right = {}};
        factors.settled = settled;
        factors.left.assign(left_.data(), left_.data() + left_.size());
        factors.right.assign(right_.data(), right_.data() + right_.size());
        return factors;
    }

private:
    Eigen::VectorXd whitened(const Eigen::VectorXd& c) const {
        Eigen::VectorXd result = c;
        if (!gram_.identity()) gram_.whiten(result.data());
        return result;
    }
    double error() const {
        double sum = 0;
        for (Index i = 0; i < rest_.rows(); ++i) {
            if (weights_(i) > 0) sum += weights_(i) * whitened(rest_.row(i)).squaredNorm();
        }
        return sum;
    }
    void add(Index r, double sign) { rest_ += sign * left_.col(r) * right_.row(r); }

    /// The best non-negative left column for this right row; `rest_` without their product.
    void fitLeft(Index r) {
        const Eigen::VectorXd b = whitened(right_.row(r));
        const double norm = b.squaredNorm();
        if (norm == 0) return;
        for (Index i = 0; i < rest_.rows(); ++i) {
            left_(i, r) = std::max(whitened(rest_.row(i)).dot(b) / norm, 0.0);
        }
    }
    /// From the row that is left the largest, as far as it is non-negative.
    void seed(Index r) {
        Index largest = 0;
        double most = -1;
        for (Index i = 0; i < rest_.rows(); ++i) {
            const double size = weights_(i) * whitened(rest_.row(i)).squaredNorm();
            if (size > most) most = size, largest = i;
        }
        setRight(r, rest_.row(largest));
        fitLeft(r);
        add(r, -1);
    }
    void improve(Index r) {
        add(r, 1);
        fitLeft(r);
        const Eigen::VectorXd weighted = weights_.cwiseProduct(left_.col(r));
        const double norm = weighted.dot(left_.col(r));
        if (norm > 0) setRight(r, rest_.transpose() * weighted / norm);
        add(r, -1);
    }
    /// For fixed left parts the error is |right - best|^2 up to a constant: the nearest in the
    /// cone.
    void setRight(Index r, const Eigen::VectorXd& best) {
        const std::vector<double> nearest = (sure_ ? cone_ : roughCone_).nearest(best.data());
        right_.row(r) = Eigen::Map<const Eigen::RowVectorXd>(nearest.data(),
                                                             static_cast<Index>(nearest.size()));
    }

    bool sure_ = false;  ///< for the last sweep
    NonNegativeCone cone_, roughCone_;
    HemisphereGram gram_;
    Eigen::VectorXd weights_;
    Matrix rest_;  ///< coefficients less the product of the factors
    Matrix left_, right_;
};

}  // namespace

RowFactors nonNegativeFactors(const WeightedRows& rows, const Basis& basis, std::size_t rank,
                              bool even, int mostSweeps) {
    return NonNegativeSearch(rows, basis, rank, even).search(mostSweeps);
}

}  // namespace hshfit::inline representation::inline factoring
