// Best wavelets of light: closed forms of lights that are constant on octants, conservation of
// flux, and agreement of a picture with the light that it shows.

#include <hshfit/error.h>
#include <hshfit/light/light_wavelets.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace hshfit;

namespace {

constexpr LightTermsOptions coarse{.firstLevel = 4, .lastLevel = 5};

TEST(LightWavelets, UniformLightIsTheScalingFunctionsOfTheOctants) {
    const Light light = SkyLight{.zenith = {1, 2, 0.5}, .ground = {1, 2, 0.5}};
    const double energy = 4 * pi * (1 + 4 + 0.25);
    const LightTerms sphere = lightTerms({&light, 1}, {}, 12, coarse);
    for (std::size_t k = 0; k <= 12; ++k)
        EXPECT_NEAR(sphere.captured[k], energy * std::min(1.0, static_cast<double>(k) / 8), 1e-10)
            << k;
    EXPECT_LT(sphere.error, 1e-12);
    // Four octants above any surface.
    const LightTerms hemisphere =
        lightTerms({&light, 1}, {.normal = Orientation{.theta = 1, .phi = 2}}, 4, coarse);
    EXPECT_NEAR(hemisphere.captured[4], energy / 2, 1e-10);
    EXPECT_NEAR(hemisphere.captured[1], energy / 8, 1e-10);
}

TEST(LightWavelets, SkiesOfTwoHalvesTakeAsManyTermsAsOctants) {
    const Light light = SkyLight{.zenith = {3, 0, 0}, .ground = {1, 0, 0}};
    const LightTerms terms = lightTerms({&light, 1}, {}, 8, coarse);
    EXPECT_NEAR(terms.captured[4], 9 * 2 * pi, 1e-10);
    EXPECT_NEAR(terms.captured[8], 10 * 2 * pi, 1e-10);
}

TEST(LightWavelets, SmallDiscsKeepTheirFlux) {
    // All flux of a disc within a leaf: its function is F / sqrt(area) there, its energy F^2 / area
    // with the leaf's area, whatever part of the leaf the disc covers.
    const double radius = 1e-4, radiance = 50;
    const Direction inside = directionFromAngles(0.9, 0.77);
    const Light light = DiscLight{inside, radius, {radiance, 0, 0}};
    const double flux = radiance * 4 * pi * std::pow(std::sin(radius / 2), 2);
    const LightTerms terms = lightTerms({&light, 1}, {}, 64, {.firstLevel = 3, .lastLevel = 3});
    const double mean = 4 * pi / (8 * 64);  // of leaves, which differ by a factor of 3 at most
    EXPECT_GT(terms.captured[64], flux * flux / (3 * mean));
    EXPECT_LT(terms.captured[64], flux * flux / (mean / 3));
    // One leaf takes a wavelet of each level and the root's function: 3 levels of 3, and 1.
    EXPECT_NEAR(terms.captured[10], terms.captured[64], 1e-12 * terms.captured[64]);
    EXPECT_LT(terms.captured[9], terms.captured[10]);
}

TEST(LightWavelets, PicturesAndTheSkiesThatTheyShowAgree) {
    const SkyLight sky{.zenith = {3, 1, 0}, .ground = {1, 0, 0.2}};
    PictureLight picture{.file = "made", .width = 64, .height = 32, .rgb = {}};
    for (std::size_t row = 0; row < picture.height; ++row)
        for (std::size_t column = 0; column < picture.width; ++column)
            for (std::size_t c = 0; c < 3; ++c)
                picture.rgb.push_back(
                    static_cast<float>(row < picture.height / 2 ? sky.zenith[c] : sky.ground[c]));
    const Light one = sky, other = picture;
    const LightTerms a = lightTerms({&one, 1}, {}, 30, coarse),
                     b = lightTerms({&other, 1}, {}, 30, coarse);
    for (std::size_t k = 0; k <= 30; ++k)
        EXPECT_NEAR(a.captured[k], b.captured[k], 2e-3 * a.captured[30]) << k;
}

TEST(LightWavelets, ParallelLightHasNone) {
    const Light light = DirectionalLight{{0, 0, 1}, {1, 1, 1}};
    EXPECT_THROW(lightTerms({&light, 1}, {}, 4), UsageError);
}

}  // namespace
