// Direct integration of functions that are below 0 at places.

#include <hshfit/rendering/direct_integral.h>
#include <hshfit/rendering/view.h>

#include "lib/blurred_mirror.h"
#include "lib/formula_brdf.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace hshfit;

namespace {

/// f = wi.x cancels to 0 under an even sky, where no share of the radiance bounds the error: the
/// bound is a share of the integral of |f| cos, which is 4/3.
TEST(DirectIntegral, SumsThatCancelEndWithoutCuttingCellsOnAndOn) {
    const test::FormulaBrdf odd([](const Direction& wi, const Direction&) { return wi.x; });
    const std::vector<Light> furnace = {SkyLight{.zenith = {1, 1, 1}, .ground = {1, 1, 1}}};
    const IntegrationOptions options;
    const PointRadiance found =
        DirectIntegral(furnace).at(odd, frameAt({0.6, 0, 0.8}), {0, 0.6, 0.8}, options);
    const double whole = 4 / 3.0;
    EXPECT_FALSE(found.cut);
    EXPECT_LT(found.evaluations, options.maxEvaluations / 8);
    EXPECT_LE(found.error, options.tolerance * 3 * whole);
    for (const double value : found.radiance) EXPECT_LE(std::abs(value), options.tolerance * whole);
}

/// The mirror image of a disc of 30 degrees about the normal: 1 inside and 0 outside.
TEST(DirectIntegral, NarrowLobesReflectWideDiscsWithSharpEdges) {
    const Direction normal{0.6, 0, 0.8};
    const std::vector<Light> disc = {DiscLight{normal, radians(30), {1, 1, 1}}};
    const test::BlurredMirror mirror(1e-3);
    for (const double degree : {0.0, 12.0, 29.0, 33.0, 50.0}) {
        const IntegrationOptions options;
        const PointRadiance found = DirectIntegral(disc).at(
            mirror, frameAt(normal), directionFromAngles(radians(degree), 0.4), options);
        EXPECT_FALSE(found.cut);
        EXPECT_LT(found.evaluations, 100000u);
        EXPECT_NEAR(found.radiance[0], degree < 30 ? 1 : 0, options.tolerance) << degree;
    }
}

TEST(DirectIntegral, NarrowLobesReflectEvenLightWithoutLoss) {
    for (const double width : {1e-2, 1e-3, 1e-4}) {
        const test::BlurredMirror mirror(width);
        const std::vector<Light> even = {DiscLight{{0, 0, 1}, pi, {1, 1, 1}}};
        for (const double degree : {0.0, 33.0, 60.0, 75.0}) {
            const IntegrationOptions options;
            const PointRadiance found = DirectIntegral(even).at(
                mirror, frameAt({0.6, 0, 0.8}), directionFromAngles(radians(degree), 0.4), options);
            EXPECT_FALSE(found.cut);
            EXPECT_NEAR(found.radiance[0], 1, options.tolerance) << width << " " << degree;
        }
    }
}

}  // namespace
