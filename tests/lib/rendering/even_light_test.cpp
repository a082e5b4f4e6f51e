// Radiance under even light from a table over the viewer's directions: closed forms, the direct
// integral over all models, and functions that no table serves.

#include <hshfit/brdf/vectors.h>
#include <hshfit/rendering/internal/even_light.h>
#include <hshfit/rendering/view.h>

#include <brdfs/catalog.h>
#include <brdfs/catalog/tables.h>
#include <brdfs/random_cases.h>

#include "lib/formula_brdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace hshfit;

namespace {

constexpr std::size_t plenty = 100'000;
const IntegrationOptions options;

EvenLight tableOf(const Brdf& brdf, std::size_t most = plenty) {
    return {brdf, options, most, [] { return true; }};
}

std::vector<Direction> viewers(std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<Direction> all = {{0, 0, 1}};
    while (all.size() < count)
        all.push_back(directionFromAngles(std::acos(share(random)), 2 * pi * share(random)));
    return all;
}

/// f = q(wo) / pi has the radiance q(wo).
test::FormulaBrdf evenOver(const std::function<double(const Direction&)>& q) {
    return test::FormulaBrdf([q](const Direction&, const Direction& wo) { return q(wo) / pi; }, {},
                             {.isotropic = false});
}

TEST(EvenLight, ClosedFormsOfTheViewer) {
    const auto q = [](const Direction& wo) {
        return 0.5 + 0.3 * wo.x - 0.15 * wo.y + 0.2 * wo.x * wo.y * wo.z;
    };
    const test::FormulaBrdf brdf = evenOver(q);
    const EvenLight table = tableOf(brdf);
    std::size_t served = 0;
    for (const Direction& wo : viewers(2000)) {
        const auto value = table.at(wo);
        if (!value) continue;
        ++served;
        EXPECT_NEAR(value->radiance[0], q(wo), options.tolerance / 4 * q(wo));
        EXPECT_LE(std::abs(value->radiance[0] - q(wo)), value->error + 1e-12);
    }
    // All but the last two degrees, sin(2 degrees) of the directions.
    EXPECT_GT(served, 1900u);
}

TEST(EvenLight, AJumpIsNeverInterpolated) {
    for (const double at : {0.3, 0.301, 0.55, 0.7}) {
        const auto q = [at](const Direction& wo) { return wo.x > at ? 1.0 : 0.2; };
        const test::FormulaBrdf brdf = evenOver(q);
        const EvenLight table = tableOf(brdf);
        std::size_t served = 0;
        for (const Direction& wo : viewers(4000)) {
            const auto value = table.at(wo);
            if (!value) continue;
            ++served;
            EXPECT_NEAR(value->radiance[0], q(wo), options.tolerance) << at << " " << wo.x;
        }
        EXPECT_GT(served, 3600u) << at;
    }
}

TEST(EvenLight, NotFiniteAndTooFewIntegralsServeNowhere) {
    const test::FormulaBrdf holed =
        evenOver([](const Direction& wo) { return wo.x > 0.5 ? std::nan("") : 1.0; });
    const EvenLight table = tableOf(holed);
    for (const Direction& wo : viewers(1000)) EXPECT_FALSE(wo.x > 0.5 && table.at(wo));
    const test::FormulaBrdf one = evenOver([](const Direction&) { return 1.0; });
    EXPECT_FALSE(tableOf(one, 40).at({0, 0, 1}));
    EXPECT_EQ(tableOf(one, 40).evaluations(), 0u);
    const EvenLight late(one, options, plenty, [] { return false; });
    EXPECT_FALSE(late.at({0, 0, 1}));
}

TEST(EvenLight, EveryModelAgreesWithItsDirectIntegral) {
    const std::vector<Light> even = {DiscLight{{0, 0, 1}, pi, {1, 1, 1}}};
    const DirectIntegral light(even);
    const Frame frame = frameAt({0, 0, 1});
    brdfs::Draws draws(7);
    for (const brdfs::Model& model : brdfs::models()) {
        const std::string spec = brdfs::randomSpec(model, draws, brdfs::DrawFrom::typical);
        const auto brdf = brdfs::open(spec);
        const EvenLight table = tableOf(*brdf, 800);
        std::size_t served = 0;
        for (const Direction& wo : viewers(30)) {
            const auto value = table.at(wo);
            if (!value) continue;
            ++served;
            const PointRadiance direct = light.at(*brdf, frame, wo, options);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(value->radiance[c], direct.radiance[c],
                            options.tolerance * std::abs(direct.radiance[c]))
                    << spec << " " << degrees(polarAngle(wo));
        }
        EXPECT_GT(served, brdf->laws().isotropic ? 25u : 0u) << spec;
    }
}

}  // namespace
