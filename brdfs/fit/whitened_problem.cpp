// The members of FitProblem for values whose errors are correlated.

#include <brdfs/fit/dense.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/whitening.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using RowMajor = linear_algebra::RowMajor;

}  // namespace

WeightedRows FitProblem::weightedRows(std::span<const double> x) const {
    WeightedRows rows = rowsAt(x);
    if (!whitening_) return rows;
    const std::size_t n = x.size(), count = rows.residuals.size();
    Matrix whole = Matrix::Zero(at(count), at(n + 1));
    for (std::size_t v = 0; v < count; ++v) {
        for (std::size_t i = 0; i < rows.columns; ++i)
            whole(at(v), at(rows.place(i, v / rows.samples, shapeCount()))) =
                rows.slopes[v * rows.columns + i];
        whole(at(v), at(n)) = rows.residuals[v];
    }
    whitening_->apply(whole);
    rows.whitened = true;
    rows.columns = n;
    rows.slopes.resize(count * n);
    Eigen::Map<RowMajor>(rows.slopes.data(), at(count), at(n)) = whole.leftCols(at(n));
    Eigen::Map<Vector>(rows.residuals.data(), at(count)) = whole.col(at(n));
    return rows;
}

std::vector<double> FitProblem::weighted(std::vector<double> changes) const {
    for (std::size_t v = 0; v < changes.size(); ++v)
        changes[v] *= std::sqrt(samples_.weight(v / samples_.size(), v % samples_.size()));
    if (whitening_) whitening_->apply(Eigen::Map<Matrix>(changes.data(), at(changes.size()), 1));
    return changes;
}

Equations FitProblem::whitenedJoint(std::span<const double> x, bool derivatives,
                                    std::span<const double> inverse) const {
    Equations result;
    if (!derivatives) {
        for (const double r : weighted(residuals(x))) result.cost += r * r / (2 * normalisation_);
        return result;
    }
    const WeightedRows rows = weightedRows(x);
    const Eigen::Index count = at(rows.residuals.size()), n = at(x.size());
    const Eigen::Map<const RowMajor> slopes(rows.slopes.data(), count, n);
    const Eigen::Map<const Vector> residual(rows.residuals.data(), count);
    result.cost = residual.squaredNorm() / (2 * normalisation_);
    result.gradient.resize(x.size());
    result.hessian.resize(x.size() * x.size());
    Eigen::Map<Vector>(result.gradient.data(), n) = slopes.transpose() * residual / -normalisation_;
    Eigen::Map<Matrix>(result.hessian.data(), n, n) = slopes.transpose() * slopes / normalisation_;
    if (inverse.empty()) return result;
    constexpr double least = 1e-6;  // as of independent values
    const Matrix own = Eigen::Map<const Matrix>(inverse.data(), n, n) / normalisation_;
    const Vector leverage = (slopes * own).cwiseProduct(slopes).rowwise().sum();
    const Vector alone = residual.array() / (1 - leverage.array()).max(least);
    const Matrix pulled = slopes.array().colwise() * alone.array();
    result.spread.resize(result.hessian.size());
    Eigen::Map<Matrix>(result.spread.data(), n, n) =
        pulled.transpose() * pulled / (normalisation_ * normalisation_);
    return result;
}

}  // namespace hshfit::brdfs
