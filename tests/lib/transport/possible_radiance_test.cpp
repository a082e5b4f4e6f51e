// Pictures that the light of their scene can make pass, others do not.

#include <hshfit/error.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/transport/possible_radiance.h>

#include <lib/transport/law_scenes.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hshfit {
namespace {

/// A ball in even light of 2, seen as a picture of 4 x 2 pixels of radiance 0.5 but for one.
struct Scene {
    explicit Scene(const std::string& brdf, const std::string& light = "uniform:radiance=2")
        : lights(parseLights(light).lights),
          surfaces({test::materialOf(brdf)}, {{"ball", sphereMesh(2), 0, {}}}, lights) {}

    bool takes(float value, float error = 0, int samples = 64) const {
        std::vector<float> radiance(24, 0.5F), errors(24, 0.F);
        radiance[16] = value;
        errors[16] = error;
        try {
            requirePossible({.name = "front",
                             .width = 4,
                             .radiance = radiance,
                             .error = errors,
                             .samples = samples},
                            surfaces, lights);
        } catch (const NumericError& refusal) {
            message = refusal.what();
            return false;
        }
        return true;
    }

    std::vector<Light> lights;
    SurfaceScene surfaces;
    mutable std::string message = {};
};

TEST(PossibleRadiance, EndsAtTheSumOfAllReflections) {
    // 2 + 0.75 * 2 + 0.75^2 * 2 + … = 8, and 7 % of room for what is sampled.
    const Scene scene("lambert:kd=0.75");
    for (const float value : {0.F, 2.F, 7.9F, -7.9F}) EXPECT_TRUE(scene.takes(value)) << value;
    EXPECT_FALSE(scene.takes(8.7F));
    for (const char* part : {"front", "8.7", "column 1, row 1", "beyond 8"})
        EXPECT_NE(scene.message.find(part), std::string::npos) << scene.message;
    EXPECT_FALSE(scene.takes(-8.7F));
}

TEST(PossibleRadiance, HasNoEndWhereSurfacesReflectAllLightOrLightIsDirectional) {
    EXPECT_TRUE(Scene("lambert:kd=1").takes(1e9F));
    EXPECT_TRUE(Scene("phong:exponent=22,ks=10").takes(1e9F));
    EXPECT_TRUE(Scene("lambert:kd=0.5", "directional:elevation=40,irradiance=1").takes(1e9F));
    for (const float value : {std::numeric_limits<float>::infinity(), std::nanf("")})
        EXPECT_FALSE(Scene("lambert:kd=1").takes(value));
}

TEST(PossibleRadiance, LeavesRoomForTheNoiseOfSamples) {
    const Scene scene("lambert:kd=0.75");
    // One sample of many in the brightest spot: mean and standard error are the same.
    EXPECT_TRUE(scene.takes(100, 100));
    EXPECT_FALSE(scene.takes(100, 10));
    EXPECT_TRUE(scene.takes(100, 0, 4)) << "too few samples to know their error";
    // Means of pictures more than a thousand times the bound are no noise.
    EXPECT_FALSE(scene.takes(1e26F, 1e26F, 4));
    EXPECT_FALSE(scene.takes(24.F * 8600, 1e9F));
    EXPECT_TRUE(scene.takes(24.F * 7900, 1e9F));
}

TEST(PossibleRadiance, OfOneReflectionIsTheBrightestLight) {
    const auto lights = parseLights("uniform:radiance=2").lights;
    const std::vector<float> radiance{1.9F, 0, 0, 0, 0, 0, 0, 2.2F, 0, 0, 0, 0};
    const auto brdf = brdfs::open("lambert:kd=0.9");
    const CheckedPicture whole{.name = "ball", .width = 2, .radiance = radiance};
    CheckedPicture first = whole;
    first.radiance = first.radiance.first(6);
    EXPECT_NO_THROW(requirePossible(first, *brdf, lights));
    EXPECT_THROW(requirePossible(whole, *brdf, lights), NumericError);
    // A lobe that reflects more than it receives may be brighter.
    EXPECT_NO_THROW(requirePossible(whole, *brdfs::open("phong:exponent=22,ks=10"), lights));
}

TEST(PossibleRadiance, KnowsTheBrightestPlaceOfEveryLight) {
    const auto brightest = [](const std::string& light) {
        return brightestOf(parseLights(light).lights).value();
    };
    EXPECT_NEAR(brightest("uniform:radiance=1/3/2"), 3 * 1.05, 0.01);
    EXPECT_NEAR(brightest("panel:elevation=40,width=10,height=5,radiance=7"), 7, 1e-9);
    EXPECT_NEAR(brightest("sun:elevation=40,radiance=7 + panel:elevation=20,width=9,height=9,"
                          "radiance=2"),
                9, 1e-9);
    // The CIE overcast sky is brightest at the zenith.
    EXPECT_NEAR(brightest("sky:type=1,radiance=2"), 2 * 1.05, 0.01);
    EXPECT_FALSE(
        brightestOf(parseLights("directional:elevation=40,irradiance=1").lights).has_value());
}

TEST(Pictures, WithValuesThatAreNotFiniteAreNotWritten) {
    RgbPicture picture{2, 2, std::vector<float>(12, 0.5F)};
    EXPECT_NO_THROW(rgbPng(picture, 0));
    picture.values[10] = std::nanf("");
    try {
        requireFinite("front.png", 2, picture.values);
        ADD_FAILURE();
    } catch (const NumericError& error) {
        EXPECT_NE(std::string(error.what())
                      .find("front.png: the value nan of the pixel in column "
                            "1, row 1"),
                  std::string::npos)
            << error.what();
    }
    EXPECT_THROW(rgbPng(picture, 0), NumericError);
}

}  // namespace
}  // namespace hshfit
