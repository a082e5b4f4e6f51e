#include <hshfit/bases/catalog.h>

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "quadrature.h"

namespace hshfit {
namespace {

class OrthonormalBasis : public testing::TestWithParam<const bases::Entry*> {};

std::vector<const bases::Entry*> orthonormalEntries() {
    std::vector<const bases::Entry*> rows;
    for (const bases::Entry& entry : bases::catalog())
        if (entry.orthonormal) rows.push_back(&entry);
    return rows;
}

double worstGramError(const bases::Entry& entry, int order, std::size_t nodes) {
    const auto basis = entry.make(std::min(order, entry.maxOrder), {});
    const quadrature::Rule rule = quadrature::ruleOf(*basis, nodes);
    double worst = 0;
    for (int m = 0; m < basis->order(); ++m)
        worst = std::max(worst, quadrature::gramError(*basis, m, rule));
    return worst;
}

// All integrands are polynomials in mu of degree at most 2 order - 1.
TEST_P(OrthonormalBasis, AtOrder32) {
    EXPECT_LE(worstGramError(*GetParam(), 32, 64), 1e-12);
}

TEST_P(OrthonormalBasis, AtOrder256) {
    EXPECT_LE(worstGramError(*GetParam(), 256, 512), 1e-10);
}

TEST_P(OrthonormalBasis, OverTheWholeDomain) {
    constexpr int order = 6, azimuths = 2 * order;
    const auto basis = GetParam()->make(std::min(order, GetParam()->maxOrder), {});
    const quadrature::Rule rule = quadrature::ruleOf(*basis, 12);
    const int slots = basis->slots();
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(slots, slots);
    Eigen::VectorXd values(slots);
    for (std::size_t i = 0; i < rule.points.size(); ++i) {
        for (int k = 0; k < azimuths; ++k) {
            const double mu = rule.points[i].mu, sine = std::sqrt((1 - mu) * (1 + mu));
            const double phi = 2 * pi * k / azimuths + 0.1;
            basis->evaluate({sine * std::cos(phi), sine * std::sin(phi), mu}, values.data());
            gram += rule.weights(static_cast<Eigen::Index>(i)) * (2 * pi / azimuths) * values *
                    values.transpose();
        }
    }
    for (int l = 0; l < basis->order(); ++l)
        for (int m = -l; m <= l; ++m) gram(slotOf(l, m), slotOf(l, m)) -= basis->has(l, m) ? 1 : 0;
    EXPECT_LE(gram.cwiseAbs().maxCoeff(), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(Catalog, OrthonormalBasis, testing::ValuesIn(orthonormalEntries()),
                         [](const auto& row) {
                             std::string name(row.param->name);
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace hshfit
