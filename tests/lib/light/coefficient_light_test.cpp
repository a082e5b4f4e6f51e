// Files of light coefficients as lights: closed forms, and the law that light projected from
// coefficients has the same coefficients.

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/coefficient_light.h>
#include <hshfit/light/light_health.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/light/placement.h>
#include <hshfit/projection/projection.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include <unistd.h>

using namespace hshfit;

namespace {

LightCoefficients series(const std::string& basis, int order, LightCoefficients::Domain domain,
                         bool condonShortley = false) {
    LightCoefficients light;
    light.basis = basis;
    light.order = order;
    light.domain = domain;
    light.condonShortley = condonShortley;
    light.normalTheta = 0.8;
    light.normalPhi = -1.9;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> value(-1, 1);
    for (std::size_t k = 0; k < 3 * light.slots(); ++k) light.values.push_back(value(random));
    return light;
}

constexpr auto sphere = LightCoefficients::Domain::sphere;
constexpr auto hemisphere = LightCoefficients::Domain::hemisphere;

TEST(CoefficientLight, RadianceOfTheFirstBandsIsItsClosedForm) {
    LightCoefficients c = series("sh", 2, sphere);
    c.values.assign(12, 0.0);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        c.at(channel)[0] = 2 * std::sqrt(4 * pi);  // radiance 2 everywhere
        c.at(channel)[3] = std::sqrt(4 * pi / 3);  // slot of m = 1: x
    }
    const Light light = scaled(turned(coefficientLight(c, "x.json"), pi / 2), 3);
    for (const Direction& d : {Direction{0, 0, 1}, {0.6, 0, -0.8}, {0, 1, 0}, {0, -0.6, 0.8}}) {
        const Rgb radiance = radianceFrom({&light, 1}, d);
        EXPECT_NEAR(radiance[1], 3 * (2 + d.y), 1e-13);  // x turned towards y
    }
}

TEST(CoefficientLight, ProjectionOntoItsOwnBasisGivesTheCoefficientsAgain) {
    for (const bool signs : {false, true}) {
        const LightCoefficients c = series("sh", 7, sphere, signs);
        const Light light = coefficientLight(c, "x.json");
        const auto basis = bases::make("sh", 9, {.condonShortley = !signs});
        const LightCoefficients again = projectLight({&light, 1}, *basis);
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (int l = 0; l < 9; ++l)
                for (int m = -l; m <= l; ++m)
                    EXPECT_NEAR(again.at(channel)[slotOf(l, m)],
                                l >= 7 ? 0 : azimuthSign(m, true) * c.at(channel)[slotOf(l, m)],
                                1e-14);
        double squares = 0;
        for (const double value : c.values) squares += value * value;
        EXPECT_NEAR(again.energy.value, squares, 1e-12 * squares);
    }
    // A hemisphere about its own normal, by quadrature.
    const LightCoefficients c = series("hsh", 6, hemisphere);
    const Light light = coefficientLight(c, "x.json");
    const LightCoefficients again =
        projectLight({&light, 1}, *bases::make("hsh", 6),
                     {.domain = {.normal = Orientation{.theta = 0.8, .phi = -1.9}}});
    for (std::size_t k = 0; k < c.values.size(); ++k)
        EXPECT_NEAR(again.values[k], c.values[k], 1e-8);
}

TEST(CoefficientLight, TurningTurnsTheCoefficients) {
    const Light light = turned(coefficientLight(series("sh", 6, sphere), "x.json"), 0.7);
    const auto basis = bases::make("sh", 6);
    const LightCoefficients turnedSeries = projectLight({&light, 1}, *basis);
    const Light again = coefficientLight(turnedSeries, "y.json");
    for (const Direction& d : {Direction{0, 0, 1}, {0.6, 0, -0.8}, {0.28, 0.96, 0}}) {
        const Rgb a = radianceFrom({&light, 1}, d), b = radianceFrom({&again, 1}, d);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-13);
    }
}

TEST(CoefficientLight, IsZeroBesideItsHemisphere) {
    const CoefficientLight light = coefficientLight(series("hsh", 4, hemisphere), "x.json");
    const Direction below{-light.normal.x, -light.normal.y, -light.normal.z};
    EXPECT_EQ(radianceOf(light, below), Rgb{});
    EXPECT_NE(radianceOf(light, light.normal), Rgb{});
}

TEST(CoefficientLight, SamplesIntegrateTheCosineOfASurface) {
    // E(n) = sum of A_l L_{l,m} Y_{l,m}(n), A = pi, 2 pi / 3, pi / 4 (Ramamoorthi & Hanrahan 2001).
    const LightCoefficients c = series("sh", 3, sphere);
    const Light light = coefficientLight(c, "x.json");
    const Orientation place{.theta = 1.1, .phi = 0.4};
    const Frame frame(place);
    double y[9];
    bases::make("sh", 3)->evaluate(frame.normal, y);
    const double factors[] = {pi, 2 * pi / 3, pi / 4};
    const LightSamples samples = sampleLights({&light, 1}, frame, 2);
    const LightSamples lattice = latticeSamples({&light, 1}, frame, 200000);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        double expected = 0, sum = 0, rough = 0;
        for (int l = 0; l < 3; ++l)
            for (int m = -l; m <= l; ++m)
                expected += factors[l] * c.at(channel)[slotOf(l, m)] * y[slotOf(l, m)];
        for (std::size_t k = 0; k < samples.count(); ++k)
            sum += samples.flux[channel][k] * samples.z[k];
        for (std::size_t k = 0; k < lattice.count(); ++k)
            rough += lattice.flux[channel][k] * lattice.z[k];
        EXPECT_NEAR(sum, expected, 1e-9);
        EXPECT_NEAR(rough, expected, 2e-3);
    }
}

TEST(CoefficientLight, FilesAreTermsOfASpecification) {
    const std::string folder =
        std::filesystem::temp_directory_path() / ("hshfit-light-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const std::string file = folder + "/a+b.json";
    writeLight(series("sh", 4, sphere), file);
    EXPECT_TRUE(looksLikeLight(file));
    const auto parsed = parseLights(file + ":scale=2+uniform:radiance=1");
    ASSERT_EQ(parsed.lights.size(), 2U);
    EXPECT_EQ(kindOf(parsed.lights[0]), "coefficients");
    EXPECT_EQ(std::get<CoefficientLight>(parsed.lights[0]).scale, 2);
    EXPECT_THROW(parseLights(file + ":layout=latlong"), UsageError);

    Coefficients brdf;
    brdf.basis = "hsh";
    brdf.order = 1;
    brdf.channels = Channels::grey();
    brdf.outgoing = OutgoingSet::direction(0, 0);
    brdf.values = {1};
    brdf.source = "lambert";
    writeCoefficients(brdf, folder + "/brdf.json");
    EXPECT_FALSE(looksLikeLight(folder + "/brdf.json"));
    try {
        parseLights(folder + "/brdf.json");
        ADD_FAILURE() << "coefficients of a BRDF were taken as light";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("of a BRDF"), std::string::npos);
    }
    std::filesystem::remove_all(folder);
}

}  // namespace
