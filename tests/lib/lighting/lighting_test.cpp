// Models of lighting against closed forms: form factors, furnaces, first moments.

#include <hshfit/lighting/harmonics.h>
#include <hshfit/lighting/lobe_nodes.h>
#include <hshfit/lighting/split_sum.h>
#include <hshfit/lighting/transformed_cosines.h>

#include "lit_formulas.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/light/light_projection.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace hshfit::lighting {
namespace {

constexpr Laws plain{.isotropic = true, .mirrorSymmetric = true};

test::FormulaBrdf lambert(double albedo) {
    return test::FormulaBrdf([=](const Direction&, const Direction&) { return albedo / pi; }, {},
                             plain);
}

/// (cos alpha)^n / cos(theta_i) about the mirror direction, over an even part.
test::FormulaBrdf phong(double n, double even) {
    return test::FormulaBrdf(
        [=](const Direction& wi, const Direction& wo) {
            const double c = std::max(0.0, dot(wi, mirrored(wo)));
            return even / pi + (n + 2) / (2 * pi) * std::pow(c, n);
        },
        {}, plain);
}

const std::array<Direction, 3> normals{Direction{0, 0, 1}, directionFromAngles(0.9, 2.1),
                                       directionFromAngles(2.6, -0.7)};

/// A viewer at an elevation above the surface.
Direction viewerAt(const Direction& normal, double cosine) {
    const ViewAxes axes(normal, directionFromAngles(1.4, 0.3));
    return axes.toWorld({std::sqrt(1 - cosine * cosine), 0, cosine});
}

/// The integral of f cos L for L = 1 + slope . w, by the nodes of f.
double linearTruth(const Brdf& brdf, const Direction& normal, const Direction& viewer,
                   const Direction& slope) {
    const ViewAxes axes(normal, viewer);
    const LobeNodes nodes = lobeNodes(brdf, axes.toLocal(viewer), 4);
    const Direction local = axes.toLocal(slope);
    double sum = 0;
    for (std::size_t k = 0; k < nodes.count(); ++k)
        sum += nodes.weights[k] * nodes.z[k] * nodes.f[0][k] *
               (1 + dot(local, {nodes.x[k], nodes.y[k], nodes.z[k]}));
    return sum;
}

TEST(ElevationTable, RowsAreAtTheirOwnElevations) {
    const ElevationRows rows{.count = 9};
    EXPECT_DOUBLE_EQ(rows.cosine(0), 1);
    EXPECT_NEAR(rows.cosine(8), ElevationRows::leastCosine, 1e-15);
    for (std::size_t k = 0; k < rows.count; ++k) {
        const auto [row, share] = rows.place(rows.cosine(k));
        EXPECT_NEAR(static_cast<double>(row) + share, static_cast<double>(k), 1e-6);
    }
    EXPECT_NEAR(rows.place(0).share, 1, 1e-12);
}

/// Form factor of a parallel rectangle a x b at height 1 whose corner is overhead (Siegel & Howell,
/// Thermal Radiation Heat Transfer, appendix C, configuration 4).
double cornerFactor(double a, double b) {
    const double x = std::sqrt(1 + a * a), y = std::sqrt(1 + b * b);
    return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2 * pi);
}

TEST(FormFactor, IsThatOfRectanglesOverheadAndStopsAtTheHorizon) {
    EXPECT_NEAR(formFactor({{{0, 0, 1}, {2, 0, 1}, {2, 0.5, 1}, {0, 0.5, 1}}}),
                cornerFactor(2, 0.5), 1e-12);
    EXPECT_NEAR(formFactor({{{-1, -3, 1}, {1, -3, 1}, {1, 3, 1}, {-1, 3, 1}}}),
                4 * cornerFactor(1, 3), 1e-12);
    const double upper = formFactor({{{1, -2, 0}, {1, 2, 0}, {1, 2, 1.5}, {1, -2, 1.5}}});
    EXPECT_NEAR(formFactor({{{1, -2, -7}, {1, 2, -7}, {1, 2, 1.5}, {1, -2, 1.5}}}), upper, 1e-12);
    EXPECT_EQ(formFactor({{{1, -2, -7}, {1, 2, -7}, {1, 2, -1}, {1, -2, -1}}}), 0);
    // A wall of height c at distance 1, of any breadth: (1 - 1 / sqrt(1 + c^2)) / 2.
    EXPECT_NEAR(formFactor({{{1, -1e6, 0}, {1, 1e6, 0}, {1, 1e6, 2}, {1, -1e6, 2}}}),
                (1 - 1 / std::sqrt(5.0)) / 2, 1e-6);
}

TEST(TransformedCosines, LambertsRowIsTheClippedFormFactor) {
    std::vector<CosineRow> even(8), rest(8);
    for (CosineRow& row : even) row.even = {0.5, 0.25, 1};
    for (CosineRow& row : rest) row.rest = {0.5, 0.25, 1};
    const AreaLight light{{{{1, -1, -0.5}, {1, 2, -0.5}, {1, 2, 2}, {1, -1, 2}}}, {3, 2, 1}};
    const Direction viewer = directionFromAngles(0.8, 0);
    const double factor = formFactor(light.corners);
    for (const auto& rows : {even, rest}) {
        const Rgb lit = radiance(cosineTable(rows), {&light, 1}, {0, 0, 1}, viewer);
        EXPECT_NEAR(lit[0], 1.5 * factor, 1e-12);
        EXPECT_NEAR(lit[1], 0.5 * factor, 1e-12);
        EXPECT_NEAR(lit[2], 1.0 * factor, 1e-12);
    }
}

TEST(TransformedCosines, UniformLightAroundReflectsTheAlbedo) {
    const std::vector<Light> lights{uniformLight()};
    const std::vector<AreaLight> tiles = areaLights(lights, 40);
    EXPECT_EQ(tiles.size(), 6u);  // uniform light needs no cuts
    std::vector<CosineRow> rows(4);
    for (CosineRow& row : rows)
        row = {.even = {0.1, 0.1, 0.1},
               .rest = {0.6, 0.5, 0.4},
               .lobe = {.a = 3, .b = 2, .c = -1.5, .d = 1.2}};
    for (const Direction& normal : normals) {
        const Rgb lit = radiance(cosineTable(rows), tiles, normal, viewerAt(normal, 0.6));
        EXPECT_NEAR(lit[0], 0.7, 1e-9);
        EXPECT_NEAR(lit[2], 0.5, 1e-9);
    }
}

TEST(AreaLights, KeepTheFluxOfASunAndOfAnUnevenSky) {
    const double radius = 0.1;
    const std::vector<Light> sun{
        DiscLight{.towards = directionFromAngles(0.5, 1), .radius = radius, .radiance = {2, 1, 0}}};
    const std::vector<AreaLight> square = areaLights(sun, 10);
    ASSERT_EQ(square.size(), 1u);
    // Seen from straight below, cos(theta) is 1 to second order: form factor = Omega / pi.
    const ViewAxes axes(directionFromAngles(0.5, 1), {0, 0, 1});
    std::array<Direction, 4> local;
    for (std::size_t k = 0; k < 4; ++k) local[k] = axes.toLocal(square[0].corners[k]);
    EXPECT_NEAR(formFactor(local) * pi, pi * radius * radius, 2e-2 * pi * radius * radius);

    const std::vector<Light> sky{linearLight({0.3, -0.5, 0.6})};
    const std::vector<AreaLight> tiles = areaLights(sky, 100);
    EXPECT_EQ(tiles.size(), 100u);
    std::vector<CosineRow> white(2);
    for (CosineRow& row : white) row.even = {1, 1, 1};
    for (const Direction& normal : normals) {
        // E / pi = 1 + 2/3 slope . n
        const double exact = 1 + 2.0 / 3 * dot(normal, {0.3, -0.5, 0.6});
        EXPECT_NEAR(radiance(cosineTable(white), tiles, normal, normal)[1], exact, 5e-3);
    }
}

TEST(Harmonics, AreThoseOfPowersOfTheCosine) {
    // f cos = 0.5 (n + 1) / pi cos^n about the normal, whatever wo.
    const double n = 4;
    const test::FormulaBrdf brdf(
        [=](const Direction& wi, const Direction&) {
            return (n + 1) / (2 * pi) * std::pow(wi.z, n - 1);
        },
        {}, plain);
    const HarmonicTable table = fitHarmonics(brdf, 4, {.count = 4});
    const double p[] = {1, (n + 1) / (n + 2), (n + 1) * (3 / (n + 3) - 1 / (n + 1)) / 2,
                        (n + 1) * (5 / (n + 4) - 3 / (n + 2)) / 2};
    for (std::size_t k = 0; k < 4; ++k) {
        for (int l = 0; l < 4; ++l) {
            const auto row = table.table.row(k);
            EXPECT_NEAR(row[harmonicTexel(l, 0) * 4], std::sqrt((2 * l + 1) / (4 * pi)) * p[l],
                        1e-5);
            for (int m = 1; m <= l; ++m)
                EXPECT_NEAR(row[harmonicTexel(l, m) * 4 + 1], 0, 1e-6) << l << ' ' << m;
        }
    }
}

TEST(Harmonics, ReflectLinearLightExactly) {
    const test::FormulaBrdf brdf = phong(12, 0.3);
    const Direction slope{0.3, -0.5, 0.6};
    const std::vector<Light> lights{linearLight(slope)};
    const ElevationRows rows{.count = 12};
    const HarmonicShading shading(fitHarmonics(brdf, 3, rows),
                                  projectLight(lights, *bases::make("sh", 3)));
    for (const Direction& normal : normals) {
        for (const std::size_t row : {0, 4, 9}) {
            const Direction viewer = viewerAt(normal, rows.cosine(row));
            EXPECT_NEAR(shading.radiance(normal, viewer)[0],
                        linearTruth(brdf, normal, viewer, slope), 5e-4);
        }
    }
}

TEST(LobeKernel, HasTheMomentsOfPowersOfTheCosine) {
    // cos^n as a function of tan(alpha / 2), by 4001 points.
    const double n = 6;
    std::vector<double> t, values;
    for (int k = 1; k <= 4001; ++k) {
        t.push_back(k / 4001.0);
        values.push_back(std::pow((1 - t.back() * t.back()) / (1 + t.back() * t.back()), n));
    }
    const LobeKernel kernel(t, values);
    EXPECT_NEAR(kernel.meanCosine(1), (n + 1) / (n + 2), 1e-4);
    EXPECT_NEAR(kernel.scaled(1).at(0.8), (n + 1) / (2 * pi) * std::pow(0.8, n), 1e-3);
    EXPECT_NEAR(kernel.scaleFor(kernel.meanCosine(0.37)), 0.37, 1e-4);
}

TEST(SplitSum, UniformLightReflectsTheAlbedoOfEachElevation) {
    const std::vector<Light> lights{uniformLight()};
    for (const double n : {3.0, 40.0}) {
        const test::FormulaBrdf brdf = phong(n, 0.2);
        const ElevationRows rows{.count = 8};
        const SplitSumTable table = fitSplitSum(brdf, rows);
        const EnvironmentCube cube = prefilter(table, lights, 16);
        const auto nine = irradianceNine(lights);
        for (std::size_t k = 0; k < rows.count; ++k) {
            const Direction wo = directionFromAngles(std::acos(rows.cosine(k)), 0);
            const double albedo = summarise(lobeNodes(brdf, wo, 2), 0).albedo[0];
            const Direction viewer = viewerAt(normals[1], rows.cosine(k));
            EXPECT_NEAR(radiance(table, cube, nine, normals[1], viewer)[0], albedo, 2e-3 * albedo);
        }
    }
}

TEST(SplitSum, LinearLightKeepsTheFirstMomentOfTheLobe) {
    const Direction slope{0.3, -0.5, 0.6};
    const std::vector<Light> lights{linearLight(slope)};
    const test::FormulaBrdf brdf = phong(12, 0.2);
    const ElevationRows rows{.count = 8};
    const SplitSumTable table = fitSplitSum(brdf, rows);
    const EnvironmentCube cube = prefilter(table, lights, 64);
    const auto nine = irradianceNine(lights);
    for (const Direction& normal : normals) {
        for (const std::size_t k : {0, 3, 5, 7}) {
            const Direction viewer = viewerAt(normal, rows.cosine(k));
            const double truth = linearTruth(brdf, normal, viewer, slope);
            EXPECT_NEAR(radiance(table, cube, nine, normal, viewer)[0], truth, 5e-3 * truth);
        }
    }
}

TEST(Lighting, LambertIsTheIrradianceOverPi) {
    const test::FormulaBrdf brdf = lambert(0.5);
    const Direction slope{0.3, -0.5, 0.6};
    const std::vector<Light> lights{linearLight(slope)};
    const SplitSumTable table = fitSplitSum(brdf, {.count = 4});
    const HarmonicShading shading(fitHarmonics(brdf, 2, {.count = 4}),
                                  projectLight(lights, *bases::make("sh", 2)));
    for (const Direction& normal : normals) {
        const double exact = 0.5 * (1 + 2.0 / 3 * dot(normal, slope));
        const Direction viewer = viewerAt(normal, 0.7);
        EXPECT_NEAR(shading.radiance(normal, viewer)[0], exact, 1e-5);
        EXPECT_NEAR(
            radiance(table, prefilter(table, lights, 8), irradianceNine(lights), normal, viewer)[0],
            exact, 1e-4);
    }
}

TEST(Lighting, TooManyBandsAreRefused) {
    EXPECT_THROW(fitHarmonics(lambert(1), 17), UsageError);
    EXPECT_THROW(fitHarmonics(lambert(1), 0), UsageError);
}

}  // namespace
}  // namespace hshfit::lighting
