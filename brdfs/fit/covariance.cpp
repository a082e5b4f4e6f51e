#include <brdfs/fit/covariance.h>

#include <Eigen/Dense>

#include <cmath>

namespace hshfit::brdfs {

Covariance covarianceOf(const Equations& equations, const std::vector<bool>& fixed,
                        std::size_t values) {
    const std::size_t all = fixed.size();
    Covariance result;
    result.variance.assign(all, -1);
    result.correlations.assign(all * all, 0);
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < all; ++i) {
        if (fixed[i]) continue;
        if (equations.hessian[i * all + i] > 0)
            free.push_back(i);
        else
            result.ambiguous.push_back({i});
    }
    const auto n = static_cast<Eigen::Index>(free.size());
    if (n == 0) return result;
    Eigen::MatrixXd hessian(n, n), spread(n, n);
    Eigen::VectorXd scale(n);
    for (Eigen::Index i = 0; i < n; ++i)
        scale(i) = std::sqrt(equations.hessian[free[i] * all + free[i]]);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) {
            const std::size_t at = free[i] * all + free[j];
            hessian(i, j) = equations.hessian[at] / (scale(i) * scale(j));
            spread(i, j) = equations.spread[at] / (scale(i) * scale(j));
        }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
    constexpr double least = 1e-9, share = 0.1;
    std::vector<bool> undetermined(free.size(), false);
    Eigen::VectorXd inverse(n);
    for (Eigen::Index e = 0; e < n; ++e) {
        const double value = eigen.eigenvalues()(e);
        inverse(e) = value > least ? 1 / value : 0;
        if (value > least) continue;
        result.ambiguous.emplace_back();
        for (Eigen::Index i = 0; i < n; ++i)
            if (std::abs(eigen.eigenvectors()(i, e)) > share) {
                result.ambiguous.back().push_back(free[i]);
                undetermined[i] = true;
            }
    }
    const Eigen::MatrixXd inverted =
        eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
    const double count = static_cast<double>(values);
    const double correction =
        count > static_cast<double>(n) ? count / (count - static_cast<double>(n)) : 1;
    // The cost, 1 for f = 0, is known to its rounding alone: parameters to the step that raises it
    // by as much.
    constexpr double rounding = 2.3e-16;
    const Eigen::MatrixXd covariance =
        correction * inverted * spread * inverted + 2 * rounding * inverted;
    for (Eigen::Index i = 0; i < n; ++i) {
        if (undetermined[i]) continue;
        result.variance[free[i]] = std::max(0.0, covariance(i, i)) / (scale(i) * scale(i));
        for (Eigen::Index j = 0; j < n; ++j) {
            const double size = std::sqrt(covariance(i, i) * covariance(j, j));
            if (!undetermined[j] && size > 0)
                result.correlations[free[i] * all + free[j]] = covariance(i, j) / size;
        }
    }
    return result;
}

}  // namespace hshfit::brdfs
