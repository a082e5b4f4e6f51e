#include <hshfit/bases/catalog.h>

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "quadrature.h"

namespace hshfit {
namespace {

Eigen::VectorXd rootWeights(const quadrature::Rule& rule) {
    return rule.weights.cwiseSqrt();
}

/// A smooth function of theta for every m, in no polynomial space.
Eigen::VectorXd sampleFunction(int m, const quadrature::Rule& rule) {
    Eigen::VectorXd f(rule.weights.size());
    for (Eigen::Index i = 0; i < f.size(); ++i) {
        const double mu = rule.points[static_cast<std::size_t>(i)].mu;
        f(i) = std::exp(2 * mu) * std::pow(1 - mu * mu, 0.5 * m) / (1.3 + std::cos(3 * mu + m));
    }
    return f;
}

/// Moments <f, analysis function> of the function whose m >= 0 parts are `sampleFunction`.
std::vector<double> momentsOf(const Basis& basis, const quadrature::Rule& rule) {
    std::vector<double> moments(static_cast<std::size_t>(basis.slots()));
    for (int m = 0; m < basis.order(); ++m) {
        const Eigen::VectorXd y = quadrature::analysisTable(basis, m, rule) *
                                  rule.weights.asDiagonal() * sampleFunction(m, rule);
        for (int l = m; l < basis.order(); ++l) moments[slotOf(l, m)] = y(l - m);
    }
    return moments;
}

TEST(Lsosh, AnalysisFunctionsAreOrthonormalAndTriangularToSh) {
    for (const auto& [order, nodes] : {std::pair{32, 64}, std::pair{100, 128}}) {
        const auto basis = bases::make("lsosh", order);
        const auto rule = quadrature::gauss(static_cast<std::size_t>(nodes), 0, 1);
        double gramError = 0, triangleError = 0;
        for (int m = 0; m < order; ++m) {
            const auto q = quadrature::analysisTable(*basis, m, rule);
            const auto y = quadrature::thetaTable(*basis, m, rule);
            Eigen::MatrixXd gram = q * rule.weights.asDiagonal() * q.transpose();
            gram.diagonal().array() -= 1;
            Eigen::MatrixXd r = q * rule.weights.asDiagonal() * y.transpose();
            r.triangularView<Eigen::Upper>().setZero();
            gramError = std::max(gramError, gram.cwiseAbs().maxCoeff());
            triangleError = std::max(triangleError, r.cwiseAbs().maxCoeff());
        }
        EXPECT_LE(gramError, 1e-12) << order;
        EXPECT_LE(triangleError, 1e-12) << order;
    }
}

// Condition numbers of the hemisphere Gram matrix of SH, n = 2 .. 10, to the printed digits.
TEST(Lsosh, GramMatrixIsAsIllConditionedAsPublished) {
    const double printed[] = {13.9, 254, 5.9e3, 1.5e5, 4.2e6, 1.2e8, 3.5e9, 1.0e11, 3.1e12};
    const double halfDigit[] = {.05, .5, .05e3, .05e5, .05e6, .05e8, .05e9, .05e11, .05e12};
    const auto rule = quadrature::gauss(32, 0, 1);
    for (int n = 2; n <= 10; ++n) {
        const auto basis = bases::make("lsosh", n);
        double largest = 0, smallest = 1;
        for (int m = 0; m < n; ++m) {
            const Eigen::MatrixXd samples =
                quadrature::thetaTable(*basis, m, rule) * rootWeights(rule).asDiagonal();
            const Eigen::VectorXd sigma = samples.jacobiSvd().singularValues();
            largest = std::max(largest, sigma(0));
            smallest = std::min(smallest, sigma(sigma.size() - 1));
        }
        EXPECT_NEAR(std::pow(largest / smallest, 2), printed[n - 2], halfDigit[n - 2]) << n;
    }
}

TEST(Lsosh, SolvesTheGramSystem) {
    constexpr int n = 4;
    const auto basis = bases::make("lsosh", n);
    const auto rule = quadrature::gauss(64, 0, 1);
    const auto moments = momentsOf(*basis, rule);
    std::vector<double> c(moments.size());
    basis->coefficientsFromMoments(moments.data(), n, c.data());
    for (int m = 0; m < n; ++m) {
        const auto y = quadrature::thetaTable(*basis, m, rule);
        const Eigen::MatrixXd gram = y * rule.weights.asDiagonal() * y.transpose();
        const Eigen::VectorXd b = y * rule.weights.asDiagonal() * sampleFunction(m, rule);
        const Eigen::VectorXd expected = gram.ldlt().solve(b);
        for (int l = m; l < n; ++l) {
            EXPECT_NEAR(c[slotOf(l, m)], expected(l - m), 1e-11 * expected.norm());
            EXPECT_TRUE(m == 0 || c[slotOf(l, -m)] == 0);
        }
    }
}

TEST(Lsosh, ResidualIsOrthogonalToShOnTheHemisphere) {
    const auto basis = bases::make("lsosh", 12);
    const auto rule = quadrature::gauss(64, 0, 1);
    const auto moments = momentsOf(*basis, rule);
    for (int n = 1; n <= 12; ++n) {
        std::vector<double> c(static_cast<std::size_t>(n * n));
        basis->coefficientsFromMoments(moments.data(), n, c.data());
        double energy = 0, rest = 0;
        for (int m = 0; m < n; ++m) {
            const Eigen::MatrixXd y = quadrature::thetaTable(*basis, m, rule).topRows(n - m);
            Eigen::VectorXd residual = sampleFunction(m, rule);
            energy += residual.cwiseAbs2().dot(rule.weights);
            for (int l = m; l < n; ++l) residual -= c[slotOf(l, m)] * y.row(l - m).transpose();
            rest += residual.cwiseAbs2().dot(rule.weights);
            const Eigen::VectorXd products = y * rule.weights.asDiagonal() * residual;
            EXPECT_LE(products.cwiseAbs().maxCoeff(), 1e-9) << n << " " << m;
        }
        EXPECT_NEAR(basis->capturedEnergy(moments.data(), n), energy - rest, 1e-9 * energy) << n;
    }
}

// No singular value is dropped up to order 16, so the spaces are nested and nothing is lost there;
// what noise in all moments loses beyond that is what docs/explanation/bases.md calls the rank
// loss.
TEST(Lsosh, CapturedEnergyIsNestedUntilTheRankIsLost) {
    const auto basis = bases::make("lsosh", 32);
    std::mt19937 generator(7);
    std::normal_distribution<double> normal;
    std::vector<double> moments(32 * 32);
    for (double& moment : moments) moment = normal(generator);
    double last = 0, sum = 0;
    for (int n = 1; n <= 32; ++n) {
        for (int i = (n - 1) * (n - 1); i < n * n; ++i) sum += moments[i] * moments[i];
        const double energy = basis->capturedEnergy(moments.data(), n);
        EXPECT_LE(energy, sum * (1 + 1e-13));
        EXPECT_TRUE(n > 16 || std::abs(energy - sum) <= 1e-13 * sum) << n;
        EXPECT_GE(energy, last);
        last = energy;
    }
    EXPECT_LT(last, 0.99 * sum);
}

TEST(Lsosh, CoefficientsDoNotDependOnTheOrderTheBasisWasMadeFor) {
    const auto large = bases::make("lsosh", 9), small = bases::make("lsosh", 6);
    const auto rule = quadrature::gauss(64, 0, 1);
    const auto many = momentsOf(*large, rule), few = momentsOf(*small, rule);
    std::vector<double> a(36), b(36);
    large->coefficientsFromMoments(many.data(), 6, a.data());
    small->coefficientsFromMoments(few.data(), 6, b.data());
    for (std::size_t i = 0; i < 36; ++i) EXPECT_NEAR(a[i], b[i], 1e-10);
}

}  // namespace
}  // namespace hshfit
