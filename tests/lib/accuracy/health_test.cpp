#include <hshfit/accuracy/health.h>
#include <hshfit/accuracy/isotropy.h>

#include <gtest/gtest.h>
#include <lib/formula_brdf.h>
#include <tbb/global_control.h>

#include <atomic>
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

// A thousandth of an albedo of 1e36 is not 1e-3.
TEST(Health, albedosHaveARelativeTolerance) {
    const double scale = 1e36;
    std::atomic<std::size_t> evaluations = 0;
    const auto cubic = [&](const Direction& wi, const Direction& wo) {
        ++evaluations;
        return (1 + wi.x * wo.x + wi.z * wi.z * wi.z) / pi;
    };
    const Health small = examine(Formula(cubic));
    const std::size_t cost = evaluations.exchange(0);
    const Health large = examine(
        Formula([&](const Direction& wi, const Direction& wo) { return scale * cubic(wi, wo); }));
    EXPECT_LE(evaluations, cost + cost / 10);
    for (std::size_t k = 0; k < small.albedos.size(); ++k) {
        ASSERT_TRUE(large.albedos[k].converged);
        // 1 + 2/5: the integral of (1 + z^3) z over the hemisphere, over pi.
        EXPECT_NEAR(large.albedos[k].values[0] / scale, 1.4, 2e-3);
    }
    EXPECT_TRUE(large.createsEnergy());
}

// f that no level resolves: the evaluations are bounded, and the albedo has the error that is left.
TEST(Health, evaluationsAreBounded) {
    std::atomic<std::size_t> evaluations = 0;
    const auto noise = [&](const Direction& wi, const Direction&) {
        ++evaluations;
        const double turns = 43758.5453 * std::sin(1271 * wi.x + 3117 * wi.y);
        return turns - std::floor(turns) < 0.01 ? 1e32 : 0.0;
    };
    const HealthOptions options;
    const Health health = examine(Formula(noise, {}, Laws{}), options);
    // Albedos and reflectances, since the formula claims no reciprocity.
    EXPECT_LE(health.albedoEvaluations, 2 * options.albedoEvaluations);
    EXPECT_LE(evaluations, 2 * options.albedoEvaluations + 2 * options.pairs);
    EXPECT_EQ(health.albedos.size(), 29u);
    std::size_t converged = 0;  // by accident
    for (const Health::Albedo& albedo : health.albedos) {
        ASSERT_EQ(albedo.values.size(), 1u);
        EXPECT_NEAR(albedo.values[0], pi * 1e30, 1e30);  // 1e32 in a hundredth of the directions
        EXPECT_GT(albedo.error, 0);
        converged += albedo.converged;
    }
    EXPECT_LT(converged, health.albedos.size() / 2);
}

// f = 1 + wo.x / 2 at normal incidence has the deviation sin(theta_o) / (2 sqrt 2).
TEST(Isotropy, azimuthVariationIsThatOfNormalIncidence) {
    EXPECT_NEAR(azimuthVariation(Formula(lambert)), 0, 1e-12);
    const Formula tilted([](const Direction& wi, const Direction& wo) {
        return 1 + wo.x / 2 + 5 * std::hypot(wi.x, wi.y);
    });
    EXPECT_NEAR(azimuthVariation(tilted), std::sin(radians(75)) / std::sqrt(8), 1e-12);
    EXPECT_EQ(azimuthVariation(Formula([](const Direction&, const Direction&) { return 0.0; })), 0);
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
