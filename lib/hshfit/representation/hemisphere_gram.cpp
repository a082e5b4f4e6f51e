#include <hshfit/representation/hemisphere_gram.h>

#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/quadrature/quadrature.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation {
namespace {

using Matrix = linear_algebra::RowMajor;

std::vector<int> bandsOf(const Basis& basis, int m) {
    std::vector<int> bands;
    for (int l = m; l < basis.order(); ++l) {
        if (basis.has(l, m)) bands.push_back(l);
    }
    return bands;
}

/// Functions of one m at all nodes, times the root of weight and inner product: [node][band].
Matrix weightedValues(const Basis& basis, int m, const std::vector<int>& bands) {
    // In u = sqrt(mu) the integrands are polynomials of degree 4 order at most.
    const GaussRule& rule = gaussLegendre(2 * basis.order() + 4);
    std::vector<Elevation<double>> points;
    std::vector<double> roots;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double u = (1 + rule.nodes[i]) / 2, mu = u * u;
        points.push_back({mu, (1 - u) * (1 + u)});
        const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
        roots.push_back(std::sqrt(rule.weights[i] * u * (projected ? mu : 1)));
    }
    std::vector<double> values(points.size() * static_cast<std::size_t>(basis.order() - m));
    basis.theta(m, points, values.data());
    Matrix result(static_cast<Eigen::Index>(points.size()),
                  static_cast<Eigen::Index>(bands.size()));
    for (std::size_t k = 0; k < bands.size(); ++k) {
        const double* column =
            values.data() + static_cast<std::size_t>(bands[k] - m) * points.size();
        for (std::size_t p = 0; p < points.size(); ++p) {
            result(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(k)) =
                roots[p] * column[p];
        }
    }
    return result;
}

Matrix upperFactor(const Matrix& values) {
    const Eigen::Index n = values.cols();
    Matrix r = Eigen::HouseholderQR<Matrix>(values).matrixQR().topRows(n);
    r = Matrix(r.triangularView<Eigen::Upper>());
    for (Eigen::Index i = 0; i < n; ++i) {
        if (r(i, i) < 0) r.row(i) = -r.row(i);
    }
    return r;
}

}  // namespace

HemisphereGram::HemisphereGram(const Basis& basis) {
    for (int m = 0; m < basis.order(); ++m) {
        Factor factor{.bands = bandsOf(basis, m), .upper = {}};
        if (!factor.bands.empty()) {
            const Matrix r = upperFactor(weightedValues(basis, m, factor.bands));
            // A basis that is orthonormal for m = 0 is orthonormal for all m.
            if (m == 0 && (r - Matrix::Identity(r.rows(), r.cols())).norm() < 1e-6) return;
            const Eigen::VectorXd sigma =
                Eigen::JacobiSVD<Eigen::MatrixXd>(Eigen::MatrixXd(r)).singularValues();
            condition_ = std::max(condition_, sigma(0) / sigma(sigma.size() - 1));
            factor.upper.assign(r.data(), r.data() + r.size());
        }
        factors_.push_back(std::move(factor));
    }
}

void HemisphereGram::apply(Step step, double* slots) const {
    const int order = static_cast<int>(factors_.size());
    for (int m = 1 - order; m < order; ++m) {
        const Factor& factor = factors_[static_cast<std::size_t>(std::abs(m))];
        const auto n = static_cast<Eigen::Index>(factor.bands.size());
        const Eigen::Map<const Matrix> r(factor.upper.data(), n, n);
        Eigen::VectorXd x(n);
        for (Eigen::Index k = 0; k < n; ++k) {
            x(k) = slots[slotOf(factor.bands[static_cast<std::size_t>(k)], m)];
        }
        const auto upper = r.triangularView<Eigen::Upper>();
        if (step == Step::multiply) x = upper * x;
        if (step == Step::solve) upper.solveInPlace(x);
        if (step == Step::solveTransposed) upper.transpose().solveInPlace(x);
        for (Eigen::Index k = 0; k < n; ++k) {
            slots[slotOf(factor.bands[static_cast<std::size_t>(k)], m)] = x(k);
        }
    }
}

void HemisphereGram::whiten(double* slots) const {
    apply(Step::multiply, slots);
}

void HemisphereGram::unwhiten(double* slots) const {
    apply(Step::solve, slots);
}

void HemisphereGram::whitenFunctional(double* slots) const {
    apply(Step::solveTransposed, slots);
}

}  // namespace hshfit::inline representation
