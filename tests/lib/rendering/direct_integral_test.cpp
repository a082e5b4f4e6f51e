// Direct integration of functions that are below 0 at places.

#include <hshfit/rendering/direct_integral.h>
#include <hshfit/rendering/view.h>

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

}  // namespace
