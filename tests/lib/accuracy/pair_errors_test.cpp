// The errors over pairs that every command prints.
#include "lib/formula_brdf.h"

#include <hshfit/accuracy/pair_errors.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit {
namespace {

using test::FormulaBrdf;

FormulaBrdf lobeOf(double alpha) {
    return FormulaBrdf([alpha](const Direction& wi, const Direction& wo) {
        if (!(wi.z > 0 && wo.z > 0)) return 0.0;
        const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
        const double t = 1 + (x * x + y * y) / (z * z * alpha * alpha);
        return 0.1 + 1 / (pi * alpha * alpha * t * t * 4 * z);
    });
}

Direction uniform(std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double z = 1 - unit(random), turn = 2 * pi * unit(random), r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
}

PairSummary summaryWith(unsigned seed, const Brdf& f, const Brdf& g) {
    const PairReference reference(f, spreadPairs({.seed = seed}));
    return summaryOf(reference.pairs(), reference.errorsOf(evaluateOn(g, reference.pairs())));
}

TEST(PairSummary, MeansAreThoseOfUniformPairsInEveryZone) {
    const FormulaBrdf f = lobeOf(0.3), g = lobeOf(0.4);
    const PairSummary summary = summaryOf(f, g);
    std::mt19937_64 random(4);
    constexpr std::size_t parts = 1 + zoneCount;
    double sum[parts] = {}, squares[parts] = {}, count[parts] = {};
    for (int n = 0; n < 400000; ++n) {
        const Direction wi = uniform(random), wo = uniform(random);
        const double error = std::abs(std::log1p(evaluate(f, wi, wo)[0] * wi.z) -
                                      std::log1p(evaluate(g, wi, wo)[0] * wi.z));
        const double theta = std::acos(dot(wi, wo)) / 2, h = wi.z + wo.z;
        const bool in[parts] = {true, std::min(wi.z, wo.z) < std::cos(radians(80)),
                                h / (2 * std::cos(theta)) > std::cos(radians(5))};
        for (std::size_t p = 0; p < parts; ++p) {
            if (!in[p]) continue;
            sum[p] += error;
            squares[p] += error * error;
            ++count[p];
        }
    }
    for (std::size_t p = 0; p < parts; ++p) {
        const double mean = sum[p] / count[p];
        const double own = std::sqrt((squares[p] / count[p] - mean * mean) / count[p]);
        const PairSummary::Value& found = p == 0 ? summary.meanLog : summary.zones[p - 1];
        EXPECT_NEAR(found.value, mean, 4 * std::hypot(own, found.error)) << p;
        EXPECT_LT(found.error, 0.2 * mean) << p;
    }
}

TEST(PairSummary, IndependentSamplesAgreeWithinTheirErrors) {
    const FormulaBrdf f = lobeOf(0.2), g = lobeOf(0.25);
    const PairSummary a = summaryWith(1, f, g), b = summaryWith(2, f, g);
    const auto agree = [](const PairSummary::Value& x, const PairSummary::Value& y) {
        EXPECT_NE(x.value, y.value);
        EXPECT_NEAR(x.value, y.value, 4 * std::hypot(x.error, y.error));
    };
    agree(a.meanLog, b.meanLog);
    for (std::size_t z = 0; z < zoneCount; ++z) agree(a.zones[z], b.zones[z]);
    agree(a.albedo, b.albedo);
}

/// The albedo stated beside the largest difference is the reference's in the same stratum.
TEST(PairSummary, StatesTheAlbedoThatIsOff) {
    // f = (1 + cos theta_o) / pi has the albedo 1 + cos theta_o; g has it everywhere but low down.
    const double edge = 1.0 / 16;
    const FormulaBrdf f([](const Direction&, const Direction& wo) { return (1 + wo.z) / pi; });
    const FormulaBrdf g([&](const Direction&, const Direction& wo) {
        return (1 + wo.z + (wo.z < edge ? 0.25 : 0.0)) / pi;
    });
    const PairSummary summary = summaryOf(f, g);
    EXPECT_NEAR(summary.albedo.value, 0.25, 4 * summary.albedo.error + 0.01);
    EXPECT_GT(summary.albedoFrom, std::acos(edge) - 1e-9);
    EXPECT_LE(summary.albedoTo, pi / 2);
    EXPECT_LE(summary.albedoFrom, summary.albedoTo);
    EXPECT_GT(summary.albedoThere, 1 + std::cos(summary.albedoTo) - 0.03);
    EXPECT_LT(summary.albedoThere, 1 + std::cos(summary.albedoFrom) + 0.03);
}

/// Values that only the last tenth of a degree has, which a mean over solid angle does not show.
TEST(PairSummary, SeesWhatExplodesAtTheHorizon) {
    const FormulaBrdf f = lobeOf(0.3);
    for (const bool incoming : {true, false}) {
        const FormulaBrdf g([&](const Direction& wi, const Direction& wo) {
            const bool low = (incoming ? wi.z : wo.z) < 1e-3;
            return evaluate(f, wi, wo)[0] + (low ? 1e8 : 0.0);
        });
        const PairSummary summary = summaryOf(f, g);
        EXPECT_GT(summary.maximum, 1e3);
        EXPECT_LT(incoming ? summary.at.wi.z : summary.at.wo.z, 1e-3);
        EXPECT_NE(textOf(summary).find("largest"), std::string::npos);
    }
}

}  // namespace
}  // namespace hshfit
