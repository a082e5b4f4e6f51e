#include <hshfit/bases/catalog.h>

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "quadrature.h"

namespace hshfit {
namespace {

/// Eigenvectors of the Gram matrix itself, by quadrature on the upper hemisphere. Neighbours whose
/// eigenvalues differ by `gap` are told apart to rounding over gap.
void expectGramEigenvectors(int order, int m) {
    const auto rule = quadrature::gauss(64, 0, 1);
    const auto harmonics = quadrature::thetaTable(*bases::make("sh", 2 * order), m, rule);
    const auto found = quadrature::thetaTable(*bases::make("slepian", order), m, rule);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gram(
        harmonics * rule.weights.asDiagonal() * harmonics.transpose());
    const Eigen::VectorXd& share = gram.eigenvalues();  // ascending
    for (Eigen::Index j = 0; j < found.rows(); ++j) {
        const Eigen::Index i = share.size() - 1 - j;
        EXPECT_GE(share(i), 0.5 - 1e-14) << order << " " << m;
        const double above = i + 1 < share.size() ? share(i + 1) - share(i) : 1;
        const double gap = std::min({above, i > 0 ? share(i) - share(i - 1) : 1, 1.0});
        if (gap < 1e-10) continue;
        Eigen::VectorXd expected =
            (gram.eigenvectors().col(i).transpose() * harmonics).transpose() / std::sqrt(share(i));
        if (expected.dot(found.row(j)) < 0) expected = -expected;
        const double error = (expected - found.row(j).transpose()).cwiseAbs().maxCoeff();
        EXPECT_LE(error, 1e-13 / gap) << order << " m " << m << " function " << j;
    }
}

TEST(Slepian, FunctionsAreEigenvectorsOfTheGramMatrixByFallingShare) {
    for (const int order : {1, 2, 6, 13})
        for (int m = 0; m < order; ++m) expectGramEigenvectors(order, m);
}

TEST(Slepian, OrthonormalAtTheLargestOrder) {
    const int order = bases::find("slepian").maxOrder;
    const auto basis = bases::make("slepian", order);
    const auto rule = quadrature::gauss(256, 0, 1);
    for (const int m : {0, 1, 30, order - 2, order - 1})
        EXPECT_LE(quadrature::gramError(*basis, m, rule), 1e-12) << m;
}

TEST(Slepian, PositiveNextToThePole) {
    const Elevation<double> e = elevationOf(directionFromAngles(1e-3, 0));
    const auto basis = bases::make("slepian", 20);
    for (int m = 0; m < 20; ++m) {
        std::vector<double> parts(static_cast<std::size_t>(20 - m));
        basis->theta(m, {&e, 1}, parts.data());
        for (const double part : parts) EXPECT_GT(part, 0) << m;
    }
}

}  // namespace
}  // namespace hshfit
