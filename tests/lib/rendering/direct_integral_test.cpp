// Direct integration of functions that are below 0 at places.

#include <hshfit/light/coefficient_light.h>
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

/// Light of coefficients from the closed forms of their first functions: 2 + x over the sphere, and
/// 1 over the hemisphere about +x, which ends where the mirror direction leaves it.
TEST(DirectIntegral, NarrowLobesReflectSeriesOfCoefficients) {
    LightCoefficients sphere{.basis = "sh", .order = 2};
    sphere.domain = LightCoefficients::Domain::sphere;
    sphere.values.assign(12, 0.0);
    LightCoefficients half{.basis = "hsh", .order = 1};
    half.domain = LightCoefficients::Domain::hemisphere;
    half.normalTheta = pi / 2;
    half.values.assign(3, std::sqrt(2 * pi));
    for (std::size_t channel = 0; channel < 3; ++channel) {
        sphere.at(channel)[0] = 2 * std::sqrt(4 * pi);
        sphere.at(channel)[3] = std::sqrt(4 * pi / 3);  // slot of m = 1: x
    }
    const std::vector<Light> linear = {coefficientLight(sphere, "sphere.json")},
                             step = {coefficientLight(half, "half.json")};
    const Frame frame = frameAt({0.6, 0, 0.8});
    const IntegrationOptions options;
    for (const double width : {1e-2, 1e-3, 1e-4}) {
        const test::BlurredMirror mirror(width);
        for (const double degree : {0.0, 12.0, 33.0, 50.0, 75.0}) {
            const Direction wo = directionFromAngles(radians(degree), 0.4);
            const double x = frame.toWorld(mirrored(wo)).x;
            const auto radianceBy = [&](const std::vector<Light>& lights) {
                const PointRadiance found = DirectIntegral(lights).at(mirror, frame, wo, options);
                EXPECT_FALSE(found.cut);
                return found.radiance[1];
            };
            EXPECT_NEAR(radianceBy(linear), 2 + x, 2 * options.tolerance) << width << " " << degree;
            ASSERT_GT(std::abs(x), 5 * width);
            EXPECT_NEAR(radianceBy(step), x > 0 ? 1 : 0, options.tolerance)
                << width << " " << degree;
        }
    }
}

}  // namespace
