#pragma once

#include <hshfit/bases/basis.h>

#include <cstddef>
#include <memory>
#include <vector>

#include <gsl/gsl_integration.h>
#include <Eigen/Dense>

// Gauss-Legendre rules that do not come from the library. Only the sizes that GSL tabulates are
// good to the last digit: 1 to 20, 32, 64, 96, 100, 128, 256, 512, 1024.
namespace quadrature {

struct Rule {
    std::vector<hshfit::Elevation<double>> points;
    Eigen::VectorXd weights;  ///< d mu
};

inline Rule gauss(std::size_t n, double from, double to) {
    const std::unique_ptr<gsl_integration_glfixed_table,
                          decltype(&gsl_integration_glfixed_table_free)>
        table(gsl_integration_glfixed_table_alloc(n), gsl_integration_glfixed_table_free);
    Rule rule{{}, Eigen::VectorXd(static_cast<Eigen::Index>(n))};
    for (std::size_t i = 0; i < n; ++i) {
        double mu = 0, weight = 0;
        gsl_integration_glfixed_point(from, to, i, &mu, &weight, table.get());
        rule.points.push_back({mu, 1 - mu});
        rule.weights(static_cast<Eigen::Index>(i)) = weight;
    }
    return rule;
}

/// On [0, 1], nodes in u = sqrt(mu): for integrands that behave like sqrt(mu) at the horizon.
inline Rule gaussInRoot(std::size_t n) {
    Rule rule = gauss(n, 0, 1);
    for (std::size_t i = 0; i < n; ++i) {
        const double u = rule.points[i].mu;
        rule.points[i] = {u * u, (1 - u) * (1 + u)};
        rule.weights(static_cast<Eigen::Index>(i)) *= 2 * u;
    }
    return rule;
}

using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Theta parts: row l - m, column point.
inline Table thetaTable(const hshfit::Basis& basis, int m, const Rule& rule) {
    Table table(basis.order() - m, static_cast<Eigen::Index>(rule.points.size()));
    basis.theta(m, rule.points, table.data());
    return table;
}

inline Table analysisTable(const hshfit::Basis& basis, int m, const Rule& rule) {
    Table table(basis.order() - m, static_cast<Eigen::Index>(rule.points.size()));
    basis.analysisTheta(m, rule.points, table.data());
    return table;
}

/// The rule of a basis' own inner product: the sphere for SH, cos(theta) for `makhotkin-flux`.
inline Rule ruleOf(const hshfit::Basis& basis, std::size_t n) {
    Rule rule = gauss(n, basis.name() == "sh" ? -1 : 0, 1);
    if (basis.inner() == hshfit::Basis::Inner::projectedSolidAngle)
        for (std::size_t i = 0; i < n; ++i)
            rule.weights(static_cast<Eigen::Index>(i)) *= rule.points[i].mu;
    return rule;
}

/// Largest deviation of the theta parts' Gram matrix for one m from the identity (from 0 where the
/// basis has no function).
inline double gramError(const hshfit::Basis& basis, int m, const Rule& rule) {
    const Table table = thetaTable(basis, m, rule);
    Eigen::MatrixXd gram = table * rule.weights.asDiagonal() * table.transpose();
    for (int l = m; l < basis.order(); ++l) gram(l - m, l - m) -= basis.has(l, m) ? 1 : 0;
    return gram.cwiseAbs().maxCoeff();
}

}  // namespace quadrature
