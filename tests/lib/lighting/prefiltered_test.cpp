// Lookups in environments that engines have prefiltered, against closed forms.

#include <hshfit/lighting/harmonics.h>
#include <hshfit/lighting/lobe_nodes.h>
#include <hshfit/lighting/prefiltered_lobes.h>

#include "lit_formulas.h"

#include <hshfit/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace hshfit::lighting {
namespace {

constexpr Laws plain{.isotropic = true, .mirrorSymmetric = true};
constexpr Laws brushed{.isotropic = false, .mirrorSymmetric = true};

/// P_r of prefilter.h by its formula, but for the factor.
double shape(double cosine, double roughness) {
    const double a2 = std::pow(roughness, 4), h2 = (1 + cosine) / 2;
    return a2 * std::max(cosine, 0.0) / std::pow(h2 * (a2 - 1) + 1, 2);
}

/// Its integral over the sphere times P_l, by a fine rule in the angle.
double moment(double roughness, unsigned l) {
    constexpr int steps = 400000;
    double sum = 0;
    for (int k = 0; k < steps; ++k) {
        const double angle = (k + 0.5) * pi / 2 / steps, c = std::cos(angle);
        sum += shape(c, roughness) * std::legendre(l, c) * std::sin(angle);
    }
    return sum * 2 * pi * (pi / 2 / steps);
}

test::FormulaBrdf ggxLike(double roughness, double diffuse, double scale) {
    return test::FormulaBrdf(
        [=](const Direction& wi, const Direction& wo) {
            const double c = dot(wi, mirrored(wo));
            return diffuse / pi + scale * shape(c, roughness) / std::max(wi.z, 1e-9);
        },
        {}, plain);
}

/// Light of radiance 1 everywhere, whose levels are all 1.
EnvironmentCube uniformCube(const Prefilter& engine) {
    EnvironmentCube cube;
    for (std::size_t k = 0; k < engine.levels; ++k)
        cube.levels.push_back({.face = 2, .rgb = std::vector<float>(72, 1.0F)});
    return cube;
}

TEST(Prefilters, RoughnessOneIsTheCosine) {
    // Zonal coefficients of cos gamma / pi (Ramamoorthi & Hanrahan 2001): 1, 2/3, 1/4, 0, -1/24.
    const std::vector<double> bands = kernelBands(1, 6);
    const double expected[] = {1, 2.0 / 3, 1.0 / 4, 0, -1.0 / 24, 0};
    for (std::size_t l = 0; l < 6; ++l) EXPECT_NEAR(bands[l], expected[l], 2e-6) << l;
}

TEST(Prefilters, BandsAreThoseOfTheFormula) {
    for (const double roughness : {0.2, 0.45, 0.8}) {
        const std::vector<double> bands = kernelBands(roughness, 40);
        const double whole = moment(roughness, 0);
        for (const unsigned l : {0U, 1U, 2U, 7U, 39U})
            EXPECT_NEAR(bands[l], moment(roughness, l) / whole, 2e-5) << roughness << ' ' << l;
    }
    for (const double sharp : kernelBands(0, 64)) EXPECT_EQ(sharp, 1);
}

TEST(Prefilters, LevelsAreThoseOfTheEngines) {
    // By the engines' formulas, worked by hand.
    EXPECT_NEAR(prefilterNamed("three").levelOf(0.5), 5 * 0.75, 1e-12);
    EXPECT_NEAR(prefilterNamed("three-512").levelOf(0.5), 6 * 0.75, 1e-12);
    EXPECT_NEAR(prefilterNamed("filament").levelOf(0.5), 4 * 0.75, 1e-12);
    EXPECT_NEAR(prefilterNamed("unity").levelOf(0.5), 6 * 0.5 * 1.35, 1e-12);
    // alpha = 2^(level / 0.8) / 128: level 4 has alpha 1/4; roughness 1 is the irradiance, level 6.
    EXPECT_NEAR(prefilterNamed("babylon").levelOf(0.5), 4, 1e-12);
    EXPECT_NEAR(prefilterNamed("babylon").levelOf(1), 6, 1e-12);
    // Two elevenths a level, and the ambient light for roughness 1.
    for (const int level : {1, 3, 5})
        EXPECT_NEAR(prefilterNamed("playcanvas").levelOf(2.0 * level / 11), level, 1e-12);
    EXPECT_NEAR(prefilterNamed("playcanvas").levelOf(1), 6, 1e-12);
    EXPECT_NEAR(prefilterNamed("unreal").levelOf(0.5), 6 - 1.2, 1e-12);
    for (const Prefilter& engine : prefilters()) {
        const auto last = static_cast<double>(engine.levels - 1);
        EXPECT_NEAR(engine.levelOf(0), 0, 1e-12) << engine.name;
        EXPECT_NEAR(engine.levelOf(1), last, 1e-12) << engine.name;
        for (double place = 0.5; place <= last; place += 0.5)
            EXPECT_NEAR(engine.levelOf(engine.roughnessOf(place)), place, 1e-9) << engine.name;
        // A lookup between two levels has a mixture of their kernels.
        const std::vector<double> below = kernelBands(engine.roughnessOf(2), 9);
        const std::vector<double> above = kernelBands(engine.roughnessOf(3), 9);
        const std::vector<double> between =
            lookUpBands(levelBands(engine, 9), engine.levelOf(engine.roughnessOf(2.25)));
        for (std::size_t l = 0; l < 9; ++l)
            EXPECT_NEAR(between[l], 0.75 * below[l] + 0.25 * above[l], 1e-9);
    }
    EXPECT_THROW(prefilterNamed("trhee"), UsageError);
}

TEST(Prefilters, CubesOfLinearLightKeepItsFirstBand) {
    const Direction slope{0.3, -0.2, 0.5};
    const std::vector<Light> lights{linearLight(slope)};
    const Prefilter& engine = prefilterNamed("three");
    const EnvironmentCube cube = prefiltered(engine, lights);
    ASSERT_EQ(cube.levels.size(), engine.levels);
    EXPECT_EQ(cube.levels.back().face, 8U);
    for (std::size_t k = 1; k < engine.levels; ++k) {
        const double first = kernelBands(engine.roughnessOf(static_cast<double>(k)), 2)[1];
        for (const Direction& d :
             {Direction{0, 0, 1}, directionFromAngles(1, 2), directionFromAngles(2.5, -1)}) {
            const double truth = 1 + first * dot(slope, d);
            // Bilinear between texels: the coarse levels' chords.
            EXPECT_NEAR(cube.at(d, static_cast<double>(k))[0], truth, k < 4 ? 3e-3 : 6e-3) << k;
        }
    }
}

TEST(Prefilters, CubesOfUniformLightAreUniform) {
    const std::vector<Light> lights{uniformLight()};
    for (const EnvironmentCube::Level& level :
         prefiltered(prefilterNamed("three"), lights).levels) {
        const auto [low, high] = std::ranges::minmax(level.rgb);
        EXPECT_NEAR(low, 1, 4e-3) << level.face;
        EXPECT_NEAR(high, 1, 4e-3) << level.face;
    }
}

TEST(PrefilteredLobes, AnEnginesOwnLobeIsFound) {
    const Prefilter& engine = prefilterNamed("three");
    const double roughness = engine.roughnessOf(3);
    const double norm = moment(roughness, 0);
    const PrefilteredTable table =
        fitPrefiltered(ggxLike(roughness, 0.2, 0.5 / norm), engine, 1, {.count = 16});
    const std::span<const double> row = table.table.row(0);
    EXPECT_LT(table.residuals[0], 2e-3);
    EXPECT_NEAR(row[0], 0.2, 2e-3);
    EXPECT_NEAR(row[4], 0.5, 2e-3);
    EXPECT_NEAR(row[7], roughness, 5e-3);
    EXPECT_NEAR(row[8], 0, 1e-6);
    // At 40 degrees the lobe still is above the horizon, and its axis is the mirror direction.
    const std::size_t k = ElevationRows{.count = 16}.place(std::cos(radians(40))).row;
    const double theta = std::acos(ElevationRows{.count = 16}.cosine(k));
    EXPECT_NEAR(table.table.row(k)[8], theta, radians(1.5));
}

/// A level of seven lies between two of six, whose mixture has another shape.
TEST(PrefilteredLobes, AsManyLevelsAsTheEngineHas) {
    const double roughness = prefilterNamed("three-512").roughnessOf(3);
    const test::FormulaBrdf brdf = ggxLike(roughness, 0, 0.5 / moment(roughness, 0));
    const auto errorSeenAlongTheNormal = [&](const char* engine) {
        const PrefilteredTable table =
            fitPrefiltered(brdf, prefilterNamed(engine), 1, {.count = 4});
        const auto sum = [](const std::vector<double>& squares) {
            return std::accumulate(squares.begin(), squares.begin() + PrefilteredTable::bands, 0.0);
        };
        return std::sqrt(sum(table.left) / sum(table.squares));
    };
    EXPECT_LT(errorSeenAlongTheNormal("three-512"), 0.01);
    EXPECT_GT(errorSeenAlongTheNormal("three"), 0.05);
}

TEST(PrefilteredLobes, UniformLightReflectsTheAlbedo) {
    for (const Prefilter& engine : prefilters()) {
        const EnvironmentCube cube = uniformCube(engine);
        for (const std::size_t lobes : {1, 2, 3}) {
            const test::FormulaBrdf brdf(
                [](const Direction& wi, const Direction& wo) {
                    const double c = std::max(0.0, dot(wi, mirrored(wo)));
                    return 0.1 + 4 * std::pow(c, 20) * (1 - wo.z * wi.z / 2);
                },
                {}, plain);
            const PrefilteredTable table = fitPrefiltered(brdf, engine, lobes);
            for (const std::size_t k : {0UL, 7UL, 15UL, 24UL, 30UL}) {
                const double cosine = ElevationRows{}.cosine(k);
                const Direction wo{std::sqrt(1 - cosine * cosine), 0, cosine};
                const LobeNodes nodes = lobeNodes(brdf, wo, 4);
                double albedo = 0;
                for (std::size_t i = 0; i < nodes.count(); ++i)
                    albedo += nodes.weights[i] * nodes.z[i] * nodes.f[0][i];
                EXPECT_NEAR(radiance(table, cube, {0, 0, 1}, wo)[0], albedo, 2e-3 * albedo)
                    << engine.name << ' ' << lobes << ' ' << k;
            }
        }
    }
}

TEST(PrefilteredLobes, MoreLobesLeaveLess) {
    const test::FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) {
            const double c = std::max(0.0, dot(wi, mirrored(wo)));
            return 0.05 + std::pow(c, 8) + 12 * std::pow(c, 300);
        },
        {}, plain);
    double before = 1;
    constexpr std::size_t rows = 12;
    for (const std::size_t lobes : {1, 2, 3, 6}) {
        const PrefilteredTable table =
            fitPrefiltered(brdf, prefilterNamed("unity"), lobes, {.count = rows});
        const double left = std::accumulate(table.residuals.begin(), table.residuals.end(), 0.0);
        EXPECT_LT(left, 0.9 * before * rows) << lobes;
        before = left / rows;
    }
}

/// Measured materials brighten steeply towards the horizon, as 1 / cos(theta_o) does.
TEST(PrefilteredLobes, AlbedosThatRiseAtTheHorizonAreKeptBetweenRows) {
    const Prefilter& engine = prefilterNamed("three");
    const auto albedo = [](double cosine) { return 0.02 / (cosine + 0.02); };
    const test::FormulaBrdf brdf(
        [&](const Direction&, const Direction& wo) { return albedo(wo.z) / pi; }, {}, plain);
    const PrefilteredTable table = fitPrefiltered(brdf, engine, 1);
    for (const double cosine : {0.015, 0.025, 0.04, 0.06, 0.1, 0.3}) {
        const Direction wo{std::sqrt(1 - cosine * cosine), 0, cosine};
        EXPECT_NEAR(radiance(table, uniformCube(engine), {0, 0, 1}, wo)[0], albedo(cosine),
                    0.03 * albedo(cosine))
            << cosine;
    }
}

/// The angles of the fifth and sixth axis are in a texel of their own.
TEST(PrefilteredLobes, SixLobesInThePlaneOfIncidence) {
    const test::FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) {
            const double c = std::max(0.0, dot(wi, mirrored(wo))),
                         back = std::max(0.0, dot(wi, wo));
            return 0.05 + std::pow(c, 6) + 6 * std::pow(c, 60) + 3 * std::pow(back, 30);
        },
        {}, plain);
    const PrefilteredTable table = fitPrefiltered(brdf, prefilterNamed("three"), 6, {.count = 16});
    EXPECT_EQ(table.table.texels, 1U + 6 + 2);
    const std::vector<Light> lights{linearLight({0.5, 0, 0.2})};
    const EnvironmentCube cube = prefiltered(*table.engine, lights);
    for (const double theta : {0.3, 0.8, 1.2}) {
        const Direction wo = directionFromAngles(theta, 0);
        const LobeNodes nodes = lobeNodes(brdf, wo, 8);
        double truth = 0;
        for (std::size_t i = 0; i < nodes.count(); ++i)
            truth += nodes.weights[i] * nodes.z[i] * nodes.f[0][i] *
                     (1 + 0.5 * nodes.x[i] + 0.2 * nodes.z[i]);
        EXPECT_NEAR(radiance(table, cube, {0, 0, 1}, wo)[0], truth, 0.01 * truth) << theta;
    }
}

/// Under uniform light no turn is seen, and under one direction every band counts alike: the error
/// of the lit lobes is the error of the coefficients themselves.
TEST(PrefilteredLobes, TurnedErrorsAreThoseOfTheCoefficients) {
    const test::FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) {
            const double c = std::max(0.0, dot(wi, mirrored(wo)));
            return 0.05 + std::pow(c, 8) + 3 * std::pow(c, 60);
        },
        {}, plain);
    const PrefilteredTable table = fitPrefiltered(brdf, prefilterNamed("three"), 2);
    const std::vector<Light> uniform{uniformLight()};
    EXPECT_LT(turnedError(table, uniform), 2e-3);
    const std::vector<Light> single{
        DirectionalLight{.towards = {0, 0, 1}, .irradiance = {1, 1, 1}}};
    const std::size_t each = table.left.size() / table.residuals.size();
    const ElevationRows& rows = table.table.rows;
    double expected = 0;
    for (std::size_t row = 0; row < table.residuals.size(); ++row) {
        // Y_{l,0}(+z)^2 / (2 l + 1) = 1 / (4 pi) in every band.
        const auto from = static_cast<std::ptrdiff_t>(row * each),
                   to = from + static_cast<std::ptrdiff_t>(each);
        // A mean over the angle, by the trapezoidal rule.
        const double here = std::acos(rows.cosine(row));
        const double before = row > 0 ? std::acos(rows.cosine(row - 1)) : here;
        const double after = row + 1 < rows.count ? std::acos(rows.cosine(row + 1)) : here;
        const double share = (after - before) / 2 / std::acos(ElevationRows::leastCosine);
        expected += share * std::sqrt(std::accumulate(table.left.begin() + from,
                                                      table.left.begin() + to, 0.0) /
                                      std::accumulate(table.squares.begin() + from,
                                                      table.squares.begin() + to, 0.0));
    }
    EXPECT_NEAR(turnedError(table, single), expected, 1e-6 * expected);
}

TEST(PrefilteredLobes, ABrushedLobeAndItsMirrorImage) {
    const test::FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) {
            const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
            return 0.1 + 3 * std::exp(-(x * x * 40 + y * y * 4) / (z * z));
        },
        {}, brushed);
    const PrefilteredTable table =
        fitPrefiltered(brdf, prefilterNamed("three"), 2, {.count = 12}, 4);
    EXPECT_FALSE(table.inPlane);
    EXPECT_EQ(table.table.azimuths.count, 5U);
    const std::vector<Light> lights{linearLight({0.4, 0.3, 0.2})};
    const EnvironmentCube cube = prefiltered(*table.engine, lights);
    const Direction normal{0, 0, 1}, tangent{1, 0, 0};
    for (const double azimuth : {0.3, 1.2, 1.9, 3.5, 5.5}) {
        const Direction wo = directionFromAngles(0.8, azimuth);
        const LobeNodes nodes = lobeNodes(brdf, wo, 4);
        double truth = 0;
        for (std::size_t i = 0; i < nodes.count(); ++i)
            truth += nodes.weights[i] * nodes.z[i] * nodes.f[0][i] *
                     (1 + 0.4 * nodes.x[i] + 0.3 * nodes.y[i] + 0.2 * nodes.z[i]);
        EXPECT_NEAR(radiance(table, cube, normal, wo, tangent)[0], truth, 0.02 * truth) << azimuth;
    }
}

TEST(PrefilteredLobes, WrongNumbersAreRefused) {
    const test::FormulaBrdf brdf([](const Direction&, const Direction&) { return 0.1; }, {}, plain);
    for (const std::size_t lobes : {0, 7})
        EXPECT_THROW(fitPrefiltered(brdf, prefilterNamed("three"), lobes), UsageError);
}

}  // namespace
}  // namespace hshfit::lighting
