#include <hshfit/bases/catalog.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "places.h"
#include "quadrature.h"
#include "reference.h"

namespace hshfit {
namespace {

const std::filesystem::path oracle = test::sharedFolder() + "/oracles/basis_values.json";

nlohmann::json readOracle() {
    std::ifstream in(oracle);
    return nlohmann::json::parse(in);
}

double number(const nlohmann::json& text) {
    return std::stod(text.get<std::string>());
}

Direction fromCosine(double mu, double phi) {
    const double sine = std::sqrt((1 - mu) * (1 + mu));
    return {sine * std::cos(phi), sine * std::sin(phi), mu};
}

TEST(BasisValues, AgreeWithTheOracle) {
    if (!exists(oracle)) GTEST_SKIP() << oracle << " is not there";
    const nlohmann::json values = readOracle();
    const std::pair<const char*, const char*> keys[] = {
        {"HSH", "hsh"}, {"SH", "sh"}, {"ZERNIKE_K", "zernike"}, {"MAKHOTKIN_B", "makhotkin-flux"}};
    for (const auto& [key, name] : keys) {
        const auto basis = bases::make(name, 61);
        std::vector<double> out(static_cast<std::size_t>(basis->slots()));
        double largest = 0, worst = 0;
        for (const auto& entry : values[key]) {
            basis->evaluate(fromCosine(number(entry["cos_theta"]), number(entry["phi"])),
                            out.data());
            const double expected = number(entry["value"]);
            largest = std::max(largest, std::abs(expected));
            worst =
                std::max(worst, std::abs(out[slotOf(entry["idx"][0], entry["idx"][1])] - expected));
        }
        EXPECT_GT(largest, 0);
        EXPECT_LE(worst, 1e-13 * largest) << name;
    }
}

// Every function of the first bands against the explicit sums of bases_reference.h.
TEST(BasisValues, AgreeWithExplicitSums) {
    constexpr int order = 13;
    for (const bases::Entry& entry : bases::catalog()) {
        if (entry.maxOrder < order || entry.name == "slepian") continue;  // no explicit sums
        const auto basis = entry.make(order, {});
        std::vector<double> out(static_cast<std::size_t>(basis->slots()));
        for (const double theta : {0.0, 1e-9, 0.2, 0.8, 1.1, 1.4, 1.5707, 1.57079632}) {
            const Direction d = directionFromAngles(theta, -0.9);
            basis->evaluate(d, out.data());
            const auto place = reference::fromVector(d.x, d.y, d.z);
            for (int l = 0; l < order; ++l)
                for (int m = -l; m <= l; ++m) {
                    const auto expected =
                        static_cast<double>(reference::value(entry.name, l, m, place));
                    EXPECT_NEAR(out[slotOf(l, m)], expected,
                                1e-13 * std::max(1.0, std::abs(expected)))
                        << entry.name << " " << l << " " << m << " at " << theta;
                }
        }
    }
}

TEST(BasisValues, HBasisFormulas) {
    const auto basis = bases::make("h-basis", 3);
    for (const double theta : {0.0, 0.3, 1.0, 1.5}) {
        const double phi = 0.8, sine = std::sin(theta), c = std::sqrt(3 / (2 * pi));
        const double q = 0.5 * std::sqrt(15 / (2 * pi)) * sine * sine;
        std::array<double, 9> v{}, expected{};
        basis->evaluate(directionFromAngles(theta, phi), v.data());
        expected[0] = 1 / std::sqrt(2 * pi);
        expected[1] = c * std::sin(phi) * sine;
        expected[2] = c * (2 * std::cos(theta) - 1);
        expected[3] = c * std::cos(phi) * sine;
        expected[4] = q * std::sin(2 * phi);
        expected[8] = q * std::cos(2 * phi);
        for (std::size_t i = 0; i < 9; ++i)
            EXPECT_NEAR(v[i], theta == 0 && i != 0 && i != 2 ? 0 : expected[i], 1e-15) << i;
    }
}

TEST(BasisValues, MakhotkinClosedForms) {
    const auto flux = bases::make("makhotkin-flux", 20), unit = bases::make("makhotkin", 20);
    std::vector<double> v(400), w(400);
    for (const double mu : {0.0, 0.05, 0.3, 0.77, 1.0}) {
        const Direction d = fromCosine(mu, 0.4);
        flux->evaluate(d, v.data());
        unit->evaluate(d, w.data());
        EXPECT_NEAR(v[0], 1 / std::sqrt(pi), 1e-15);
        EXPECT_NEAR(v[2], 2 * (3 * mu - 2) / std::sqrt(2 * pi), 4e-15);
        EXPECT_NEAR(v[3], std::sqrt(12 * mu * (1 - mu) / pi) * (mu < 1 ? std::cos(0.4) : 0), 2e-15);
        for (unsigned l = 0; l < 20; ++l) {  // (1 + x) P_l^{(0,1)} = P_l + P_{l+1}
            const double x = 2 * mu - 1;
            const double sum = std::legendre(l, x) + std::legendre(l + 1, x);
            const double left = 2 * mu * v[slotOf(int(l), 0)] * std::sqrt(2 * pi / (2 * l + 2));
            EXPECT_NEAR(left, sum, 1e-14);
        }
        for (std::size_t i = 0; i < 400; ++i) EXPECT_NEAR(w[i], std::sqrt(mu) * v[i], 1e-13);
    }
}

// c_00 sqrt(pi) is the irradiance and no other function carries flux.
TEST(BasisValues, MakhotkinFluxIsInTheFirstFunctionAlone) {
    const auto basis = bases::make("makhotkin-flux", 20);
    const quadrature::Rule rule = quadrature::gauss(20, 0, 1);
    Eigen::VectorXd cosine = rule.weights;
    for (Eigen::Index i = 0; i < cosine.size(); ++i)
        cosine(i) *= rule.points[static_cast<std::size_t>(i)].mu;
    const Eigen::VectorXd flux =
        quadrature::thetaTable(*basis, 0, rule) * cosine * std::sqrt(2 * pi);
    EXPECT_NEAR(flux(0), std::sqrt(pi), 1e-14);
    EXPECT_LE(flux.tail(19).cwiseAbs().maxCoeff(), 1e-14);
}

/// Integrals of SH times HSH over the hemisphere, rows SH, columns HSH, times `weight`(mu).
template <class Weight>
Eigen::MatrixXd changeMatrix(Weight weight) {
    const auto sh = bases::make("sh", 3), hsh = bases::make("hsh", 3);
    quadrature::Rule rule = quadrature::gaussInRoot(64);
    for (std::size_t i = 0; i < rule.points.size(); ++i)
        rule.weights(static_cast<Eigen::Index>(i)) *= weight(rule.points[i].mu);
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(9, 9);
    for (int m = -2; m <= 2; ++m) {
        const int k = std::abs(m);
        const Eigen::MatrixXd block = quadrature::thetaTable(*sh, k, rule) *
                                      rule.weights.asDiagonal() *
                                      quadrature::thetaTable(*hsh, k, rule).transpose();
        for (int l = k; l < 3; ++l)
            for (int j = k; j < 3; ++j) c(slotOf(l, m), slotOf(j, m)) = block(l - k, j - k);
    }
    return c;
}

void expectMatrix(const Eigen::MatrixXd& c, const nlohmann::json& rows) {
    for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j)
            EXPECT_NEAR(c(i, j), number(rows[i][j]), 1e-14) << i << " " << j;
}

TEST(BasisValues, ChangeFromShToHsh) {
    const Eigen::MatrixXd c = changeMatrix([](double) { return 1.0; });
    const double s = std::asinh(1.0), root2 = std::sqrt(2.0);
    EXPECT_NEAR(c(0, 0), 1 / root2, 1e-14);
    EXPECT_NEAR(c(2, 0), std::sqrt(6.0) / 4, 1e-14);
    EXPECT_NEAR(c(6, 2), std::sqrt(30.0) / 8, 1e-14);
    EXPECT_NEAR(c(3, 3), 11.0 / 8 - 9 * s / (8 * root2), 1e-14);
    EXPECT_NEAR(c(8, 8), 7 * root2 / 16, 1e-14);
    if (!exists(oracle)) GTEST_SKIP() << oracle << " is not there";
    expectMatrix(c, readOracle()["C_eq18_rowsSH_colsHSH"]);
}

// The 9 x 9 matrix printed by Gautron et al. 2004 is not their Eq. 18: it carries a weight 2 cos.
TEST(BasisValues, PrintedChangeMatrixHasTheWeightTwiceTheCosine) {
    if (!exists(oracle)) GTEST_SKIP() << oracle << " is not there";
    expectMatrix(changeMatrix([](double mu) { return 2 * mu; }),
                 readOracle()["C_printed_weight_2cos_rowsSH_colsHSH"]);
}

}  // namespace
}  // namespace hshfit
