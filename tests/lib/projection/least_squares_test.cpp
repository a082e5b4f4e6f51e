// Least squares over scattered samples, against functions whose coefficients are known.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/projection/least_squares.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit {
namespace {

/// Samples of one outgoing direction: f(wi) = sum of known coefficients times basis functions.
struct Known {
    std::vector<Direction> wi, wo;
    std::vector<double> values, coefficients;

    Known(const Basis& basis, std::size_t count, double highestPhi, double noise = 0) {
        std::mt19937_64 engine(7);
        std::uniform_real_distribution<double> uniform;
        std::normal_distribution<double> normal;
        for (int l = 0; l < basis.order(); ++l) {
            for (int m = -l; m <= l; ++m) {
                coefficients.push_back(basis.has(l, m) ? normal(engine) : 0.0);
            }
        }
        std::vector<double> functions(static_cast<std::size_t>(basis.slots()));
        for (std::size_t k = 0; k < count; ++k) {
            const double z = uniform(engine), phi = highestPhi * uniform(engine);
            wi.push_back(directionFromAngles(std::acos(z), phi));
            wo.push_back(directionFromAngles(radians(30), radians(20)));
            basis.evaluate(wi.back(), functions.data());
            double f = noise * normal(engine);
            for (std::size_t j = 0; j < functions.size(); ++j) f += coefficients[j] * functions[j];
            values.push_back(f);
        }
    }

    DirectionSamples view() const {
        return {.wi = wi,
                .wo = wo,
                .values = values,
                .channels = Channels::grey(),
                .symmetry = {},
                .name = "known"};
    }
};

double worstDifference(const Known& known, const Coefficients& c) {
    double worst = 0;
    for (std::size_t j = 0; j < known.coefficients.size(); ++j) {
        worst = std::max(worst, std::fabs(known.coefficients[j] - c.values[j]));
    }
    return worst;
}

const OutgoingSet theDirection = OutgoingSet::direction(radians(30), radians(20));

TEST(LeastSquares, bandLimitedFunctionsAreRecoveredInEveryBasis) {
    for (const bases::Entry& entry : bases::catalog()) {
        // Functions of the whole sphere are nearly dependent on the hemisphere: what rounding
        // leaves of a coefficient is the condition number times 1e-16.
        const auto basis = bases::make(entry.name, std::min(4, entry.maxOrder));
        const Known known(*basis, 400, 2 * pi);
        const auto fit = projectLeastSquares(known.view(), *basis, theDirection);
        ASSERT_TRUE(fit.coefficients.leastSquares.has_value());
        const double condition = fit.coefficients.leastSquares->condition;
        EXPECT_LT(worstDifference(known, fit.coefficients), std::max(1e-10, 1e-14 * condition))
            << entry.name;
        EXPECT_LT(fit.coefficients.leastSquares->residual, 1e-12) << entry.name;
        if (entry.orthonormal) {
            double energy = 0;
            for (const double c : known.coefficients) energy += c * c;
            EXPECT_NEAR(fit.coefficients.energy.value, energy,
                        std::max(1e-10, 1e-14 * condition) * energy * 10)
                << entry.name;
        }
    }
}

TEST(LeastSquares, aMissingHalfShowsInTheConditionNumberAndRegularisationBoundsTheAnswer) {
    const auto basis = bases::make("hsh", 6);
    const double noise = 0.01;
    const Known whole(*basis, 2000, 2 * pi, noise), half(*basis, 2000, pi, noise);
    const auto full = projectLeastSquares(whole.view(), *basis, theDirection);
    const auto bare = projectLeastSquares(half.view(), *basis, theDirection);
    const auto tame =
        projectLeastSquares(half.view(), *basis, theDirection, {.regularisation = 0.1});
    const double conditionFull = full.coefficients.leastSquares->condition;
    const double conditionHalf = bare.coefficients.leastSquares->condition;
    EXPECT_LT(conditionFull, 5);
    EXPECT_GT(conditionHalf, 100 * conditionFull);
    EXPECT_EQ(conditionHalf, tame.coefficients.leastSquares->condition);
    // Noise of 0.01 at 2000 well-spread samples moves a coefficient by about
    // 0.01 sqrt(2 pi / 2000) = 6e-4.
    EXPECT_LT(worstDifference(whole, full.coefficients), 5e-3);
    EXPECT_GT(worstDifference(half, bare.coefficients), 5e-3);
    double energy = 0;
    for (const double c : half.coefficients) energy += c * c;
    EXPECT_LT(tame.coefficients.energy.value, 1.5 * energy);
    EXPECT_GT(tame.coefficients.energy.value, 0.2 * energy);
    EXPECT_LT(tame.coefficients.leastSquares->residual, 0.2);
}

TEST(LeastSquares, isotropicSamplesServeEveryAzimuth) {
    // f = 1 + cos(theta_i) cos(phi_i - phi_o): samples at phi_o = 0 only.
    std::mt19937_64 engine(9);
    std::uniform_real_distribution<double> uniform;
    std::vector<Direction> wi, wo;
    std::vector<double> values;
    for (int k = 0; k < 3000; ++k) {
        const double theta = std::acos(uniform(engine)), phi = pi * uniform(engine);
        wi.push_back(directionFromAngles(theta, phi));
        wo.push_back(directionFromAngles(radians(80) * uniform(engine), 0));
        values.push_back(1 + std::sin(2 * theta) * std::cos(phi));
    }
    const DirectionSamples samples{
        .wi = wi,
        .wo = wo,
        .values = values,
        .channels = Channels::grey(),
        .symmetry = {.reciprocal = false, .isotropic = true, .mirrorSymmetric = true},
        .name = "isotropic"};
    const auto basis = bases::make("hsh", 8);
    const auto fit =
        projectLeastSquares(samples, *basis, OutgoingSet::direction(radians(40), radians(70)));
    std::vector<double> functions(64);
    for (const double phi : {0.3, 2.0, 5.0}) {
        basis->evaluate(directionFromAngles(0.7, phi), functions.data());
        double f = 0;
        for (std::size_t j = 0; j < 64; ++j) f += functions[j] * fit.coefficients.values[j];
        EXPECT_NEAR(f, 1 + std::sin(1.4) * std::cos(phi - radians(70)), 0.02);
    }
}

TEST(LeastSquares, tooFewSamplesAreNamed) {
    const auto basis = bases::make("hsh", 5);
    const Known known(*basis, 20, 2 * pi);
    try {
        projectLeastSquares(known.view(), *basis, theDirection);
        FAIL() << "no error";
    } catch (const NumericError& error) {
        const std::string what = error.what();
        EXPECT_NE(what.find("outgoing direction 0 (theta 30, phi 20 degrees) has 20 samples"),
                  std::string::npos)
            << what;
        EXPECT_NE(what.find("25 coefficients"), std::string::npos) << what;
    }
    const OutgoingSet elsewhere = OutgoingSet::direction(radians(80), 0);
    EXPECT_THROW(projectLeastSquares(known.view(), *basis, elsewhere), NumericError);
}

TEST(LeastSquares, oneRingOfSamplesDoesNotDetermineTheCoefficients) {
    const auto basis = bases::make("hsh", 3);
    std::vector<Direction> wi, wo;
    std::vector<double> values;
    for (int k = 0; k < 100; ++k) {
        wi.push_back(directionFromAngles(0.5, 0.1 * k));
        wo.push_back(theDirection.directions[0]);
        values.push_back(1);
    }
    const DirectionSamples samples{.wi = wi,
                                   .wo = wo,
                                   .values = values,
                                   .channels = Channels::grey(),
                                   .symmetry = {},
                                   .name = "ring"};
    EXPECT_THROW(projectLeastSquares(samples, *basis, theDirection), NumericError);
    const auto fit = projectLeastSquares(samples, *basis, theDirection, {.regularisation = 1e-3});
    EXPECT_GT(fit.coefficients.leastSquares->condition, 1e12);
    EXPECT_LT(fit.coefficients.energy.value, 100);
}

TEST(LeastSquares, elevationsNeedIsotropicSamples) {
    const auto basis = bases::make("hsh", 2);
    const Known known(*basis, 50, 2 * pi);
    EXPECT_THROW(projectLeastSquares(known.view(), *basis, OutgoingSet::elevations(4)), UsageError);
}

}  // namespace
}  // namespace hshfit
