#include <hshfit/accuracy/health.h>

#include <gtest/gtest.h>
#include <lib/formula_brdf.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

namespace hshfit {
namespace {

using Formula = test::FormulaBrdf;

double lambert(const Direction&, const Direction&) {
    return 1 / pi;
}

TEST(Health, nothingIsWrongWithLambert) {
    const Health health = examine(Formula(lambert));
    EXPECT_GT(health.pairs, 12000u);
    EXPECT_EQ(health.values, health.pairs);
    EXPECT_EQ(health.coverage, 1);
    EXPECT_EQ(health.negative, 0u);
    EXPECT_EQ(health.notFinite, 0u);
    EXPECT_EQ(health.reciprocityDefect, 0);
    EXPECT_FALSE(health.worstExchange);
    EXPECT_NEAR(health.largestAlbedo(), 1, health.albedoTolerance);
    EXPECT_EQ(health.albedos.size(), 8u);
}

TEST(Health, coverageIsTheShareOfPairs) {
    const auto above60 = [](const Direction& wi, const Direction& wo) {
        return wi.z > 0.5 && wo.z > 0.75;
    };
    EXPECT_NEAR(examine(Formula(lambert, above60)).coverage, 0.5 * 0.25, 6e-3);
    EXPECT_EQ(examine(Formula(lambert, [](auto&, auto&) { return false; })).coverage, 0);
}

// The law c_i^2 c_o has |c_i - c_o| c_i^2 c_o^2 over (c_i + c_o) c_i^2 c_o^2: no pair does better
// than 0 or worse than 1, and a law that vanishes for one order of the two reaches 1.
TEST(Health, reciprocityDefectIsBetweenZeroAndOne) {
    const Formula half(
        [](const Direction& wi, const Direction& wo) { return wi.x > wo.x ? 1.0 : 0.0; });
    EXPECT_DOUBLE_EQ(examine(half).reciprocityDefect, 1);
    const Formula skew([](const Direction& wi, const Direction&) { return wi.z; });
    const Health health = examine(skew);
    EXPECT_GT(health.reciprocityDefect, 0.05);
    EXPECT_LT(health.reciprocityDefect, 0.6);
    ASSERT_TRUE(health.worstExchange);
    EXPECT_EQ(health.worstExchange->value, health.worstExchange->wi.z);
    EXPECT_EQ(health.worstExchange->exchanged, health.worstExchange->wo.z);
    // Reciprocity is undefined if only one of the two pairs is covered.
    const Formula oneSided([](const Direction& wi, const Direction&) { return wi.z; },
                           [](const Direction& wi, const Direction& wo) { return wi.z > wo.z; });
    EXPECT_EQ(examine(oneSided).reciprocityDefect, 0);
}

TEST(Health, countsNegativeAndInfinite) {
    const Formula bad([](const Direction& wi, const Direction& wo) {
        if (wi.z < 0.1) return std::numeric_limits<double>::quiet_NaN();
        if (wo.z < 0.1) return std::numeric_limits<double>::infinity();
        return wi.z < 0.5 ? -1.0 : 1.0;
    });
    const Health health = examine(bad);
    EXPECT_GT(health.notFinite, 1000u);
    EXPECT_GT(health.negative, 1000u);
    EXPECT_LT(health.notFinite + health.negative, health.values);
    for (const auto& albedo : health.albedos) EXPECT_TRUE(albedo.values.empty());
}

TEST(Health, findsAlbedosAboveOne) {
    const Formula bright([](const Direction&, const Direction& wo) { return (2 - wo.z) / pi; });
    const Health health = examine(bright);
    EXPECT_NEAR(health.largestAlbedo(), 2 - std::cos(radians(85)), 2 * health.albedoTolerance);
    // Brightest at azimuth 45 degrees, off the axes.
    const Formula turned(
        [](const Direction&, const Direction& wo) { return (1 + wo.x * wo.y) / pi; }, {}, Laws{});
    EXPECT_NEAR(examine(turned).largestAlbedo(), 1 + std::pow(std::sin(radians(85)), 2) / 2, 2e-3);
}

TEST(Health, doesNotDependOnTheThreads) {
    const Formula skew([](const Direction& wi, const Direction& wo) { return wi.z + wo.x * 0.3; });
    const Health one = [&] {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
        return examine(skew);
    }();
    const Health all = examine(skew);
    EXPECT_EQ(one.reciprocityDefect, all.reciprocityDefect);
    EXPECT_EQ(one.coverage, all.coverage);
    EXPECT_EQ(one.largestAlbedo(), all.largestAlbedo());
}

}  // namespace
}  // namespace hshfit
