#include <brdfs/fit/covariance.h>

#include <hshfit/linear_algebra/decompositions.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr double least = 1e-9;

/// The matrix of the parameters that are not fixed and matter, scaled to a diagonal of 1.
struct Scaled {
    std::vector<std::size_t> free, without;  ///< indices of parameters that matter, and of the rest
    Eigen::VectorXd scale;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;

    Scaled(const Equations& equations, const std::vector<bool>& fixed) {
        const std::size_t all = fixed.size();
        for (std::size_t i = 0; i < all; ++i)
            if (!fixed[i]) (equations.hessian[i * all + i] > 0 ? free : without).push_back(i);
        scale.resize(count());
        for (Eigen::Index i = 0; i < count(); ++i)
            scale(i) = std::sqrt(equations.hessian[free[i] * all + free[i]]);
        if (count() > 0) eigen.compute(of(equations.hessian, all));
    }
    Eigen::Index count() const { return static_cast<Eigen::Index>(free.size()); }
    Eigen::MatrixXd of(const std::vector<double>& matrix, std::size_t all) const {
        Eigen::MatrixXd result(count(), count());
        for (Eigen::Index i = 0; i < count(); ++i)
            for (Eigen::Index j = 0; j < count(); ++j)
                result(i, j) = matrix[free[i] * all + free[j]] / (scale(i) * scale(j));
        return result;
    }
    Eigen::MatrixXd inverse() const {
        Eigen::VectorXd values = eigen.eigenvalues();
        for (double& value : values) value = value > least ? 1 / value : 0;
        return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
    }
};

}  // namespace

std::vector<double> inverseOf(const Equations& equations, const std::vector<bool>& fixed) {
    const Scaled scaled(equations, fixed);
    std::vector<double> result(fixed.size() * fixed.size(), 0);
    if (scaled.count() == 0) return result;
    const Eigen::MatrixXd inverse = scaled.inverse();
    for (Eigen::Index i = 0; i < scaled.count(); ++i)
        for (Eigen::Index j = 0; j < scaled.count(); ++j)
            result[scaled.free[i] * fixed.size() + scaled.free[j]] =
                inverse(i, j) / (scaled.scale(i) * scaled.scale(j));
    return result;
}

Covariance covarianceOf(const Equations& equations, const std::vector<bool>& fixed) {
    const std::size_t all = fixed.size();
    Covariance result;
    result.variance.assign(all, -1);
    result.correlations.assign(all * all, 0);
    result.whole.assign(all * all, 0);
    const Scaled scaled(equations, fixed);
    for (const std::size_t i : scaled.without) result.ambiguous.push_back({i});
    const Eigen::Index n = scaled.count();
    if (n == 0) return result;
    constexpr double share = 0.1;
    std::vector<bool> undetermined(scaled.free.size(), false);
    for (Eigen::Index e = 0; e < n; ++e) {
        if (scaled.eigen.eigenvalues()(e) > least) continue;
        std::vector<std::size_t> set;
        for (Eigen::Index i = 0; i < n; ++i)
            if (std::abs(scaled.eigen.eigenvectors()(i, e)) > share) {
                set.push_back(scaled.free[i]);
                undetermined[i] = true;
            }
        // Several directions of one set of parameters may be open.
        if (std::ranges::find(result.ambiguous, set) == result.ambiguous.end())
            result.ambiguous.push_back(std::move(set));
    }
    // The cost, 1 for f = 0, is known to its rounding alone: parameters to the step that raises it
    // by as much.
    constexpr double rounding = 2.3e-16;
    const Eigen::MatrixXd inverse = scaled.inverse();
    const Eigen::MatrixXd covariance =
        inverse * scaled.of(equations.spread, all) * inverse + 2 * rounding * inverse;
    for (Eigen::Index i = 0; i < n; ++i) {
        const std::size_t row = scaled.free[i];
        for (Eigen::Index j = 0; j < n; ++j)
            result.whole[row * all + scaled.free[j]] =
                covariance(i, j) / (scaled.scale(i) * scaled.scale(j));
        if (undetermined[i]) continue;
        result.variance[row] =
            std::max(0.0, covariance(i, i)) / (scaled.scale(i) * scaled.scale(i));
        for (Eigen::Index j = 0; j < n; ++j) {
            const double size = std::sqrt(covariance(i, i) * covariance(j, j));
            if (!undetermined[j] && size > 0)
                result.correlations[row * all + scaled.free[j]] = covariance(i, j) / size;
        }
    }
    return result;
}

}  // namespace hshfit::brdfs
