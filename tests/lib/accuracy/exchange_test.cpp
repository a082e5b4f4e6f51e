// The exchange of directions at the horizon, on formulas whose ratio is known.

#include <hshfit/accuracy/exchange.h>

#include <gtest/gtest.h>
#include <lib/formula_brdf.h>

#include <cmath>
#include <limits>

namespace hshfit {
namespace {

using Formula = test::FormulaBrdf;

TEST(ExchangeAtHorizon, IsOneOfReciprocalFormulas) {
    const Formula product([](const Direction& wi, const Direction& wo) { return wi.z * wo.z; });
    EXPECT_DOUBLE_EQ(exchangeAtHorizon(product).ratio(), 1);
    EXPECT_DOUBLE_EQ(exchangeAtHorizon(Formula([](auto&, auto&) { return 0.0; })).ratio(), 1);
}

// f = cos(theta_i)^2: largest from the normal to 85 degrees, where f wi.z wo.z still is a sixth of
// that to 60 degrees, the largest of all pairs.
TEST(ExchangeAtHorizon, IsThatOfAFormulaOfOneDirection) {
    const auto worst = exchangeAtHorizon(
        Formula([](const Direction& wi, const Direction&) { return wi.z * wi.z; }));
    const double low = std::cos(radians(85));
    EXPECT_NEAR(worst.ratio(), 1 / (low * low), 1e-9);
    EXPECT_NEAR(worst.wi.z, 1, 1e-12);
    EXPECT_NEAR(worst.wo.z, low, 1e-12);
}

// Where both directions are beyond 72 degrees, f is one-sided, but a thousandth of what it is
// elsewhere.
TEST(ExchangeAtHorizon, LeavesOutPairsThatCannotBeSeen) {
    const Formula dark([](const Direction& wi, const Direction& wo) {
        return wi.z < 0.3 && wo.z < 0.3 ? (wi.x > wo.x ? 1e-3 : 0.0) : 1.0;
    });
    EXPECT_DOUBLE_EQ(exchangeAtHorizon(dark).ratio(), 1);
}

TEST(ExchangeAtHorizon, ValuesThatAreNotFiniteDoNotCount) {
    const Formula broken([](const Direction& wi, const Direction&) {
        return wi.z > 0.9 ? std::numeric_limits<double>::infinity() : 1.0;
    });
    EXPECT_DOUBLE_EQ(exchangeAtHorizon(broken).ratio(), 1);
    const Formula onlyOneWay(
        [](const Direction& wi, const Direction& wo) { return wi.z > wo.z ? 1.0 : 0.0; });
    EXPECT_TRUE(std::isinf(exchangeAtHorizon(onlyOneWay).ratio()));
}

}  // namespace
}  // namespace hshfit
