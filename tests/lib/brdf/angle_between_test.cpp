#include <hshfit/brdf/vectors.h>

#include <gtest/gtest.h>

#include <limits>

namespace hshfit {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

TEST(AngleBetween, IsTheAngleToTheLastDigitsFromNothingToHalfATurn) {
    for (const double angle : {0.0, 1e-150, 1e-12, 1e-8, 1e-4, 0.5, pi / 2, 3.0}) {
        const Direction turned{std::sin(angle), 0, std::cos(angle)};
        EXPECT_NEAR(angleBetween({0, 0, 1}, turned), angle, 4 * eps * angle) << angle;
        // the rest of a half turn, which is rounded like pi
        EXPECT_NEAR(angleBetween({0, 0, -1}, turned), pi - angle, 4 * eps * pi) << angle;
    }
}

TEST(AngleBetween, DoesNotDependOnTheOrderNorOnTheAzimuth) {
    for (const double phi : {0.3, 2.0, 5.0}) {
        const Direction a = directionFromAngles(0.4, phi), b = directionFromAngles(1.3, phi);
        EXPECT_NEAR(angleBetween(a, b), 0.9, 8 * eps) << phi;
        EXPECT_EQ(angleBetween(a, b), angleBetween(b, a)) << phi;
    }
}

}  // namespace
}  // namespace hshfit
