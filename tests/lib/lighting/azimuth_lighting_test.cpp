// Models of lighting of BRDFs with a tangent, and of those whose lobes are not their own mirror
// images: closed forms at the nodes of tables, in every quarter of the azimuth.

#include "lit_formulas.h"

#include <hshfit/lighting/harmonics.h>
#include <hshfit/lighting/internal/lobe_taps.h>
#include <hshfit/lighting/lobe_nodes.h>
#include <hshfit/lighting/split_sum.h>
#include <hshfit/lighting/transformed_cosines.h>

#include <hshfit/light/light_projection.h>
#include <hshfit/rendering/view.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace hshfit::lighting {
namespace {

constexpr Laws brushed{.isotropic = false, .mirrorSymmetric = true};
constexpr Laws lawless{.isotropic = false, .mirrorSymmetric = false};
constexpr Laws twisted{.isotropic = true, .mirrorSymmetric = false};

/// A Gaussian of the half vector's slope over an even part, brushed along an axis at `turn` from
/// the tangent: mirror-symmetric for 0.
double brushedValue(const Direction& wi, const Direction& wo, double turn) {
    const Direction i = rotateAboutZ(wi, -turn), o = rotateAboutZ(wo, -turn);
    const Direction h{i.x + o.x, i.y + o.y, i.z + o.z};
    const double x = h.x / h.z / 0.6, y = h.y / h.z / 0.25;
    return 0.1 / pi + 0.5 * std::exp(-x * x - y * y);
}
test::FormulaBrdf brushedBrdf(double turn, Laws laws) {
    return test::FormulaBrdf(
        [=](const Direction& wi, const Direction& wo) { return brushedValue(wi, wo, turn); }, {},
        laws);
}
/// Isotropic, with its lobe to one side of the plane of incidence.
test::FormulaBrdf twistedBrdf() {
    return test::FormulaBrdf(
        [](const Direction& wi, const Direction& wo) {
            const double c = std::max(0.0, dot(wi, rotateAboutZ(mirrored(wo), 0.4)));
            return 0.1 / pi + std::pow(c, 8);
        },
        {}, twisted);
}

struct Case {
    const char* name;
    test::FormulaBrdf brdf;
    std::size_t azimuths;
};
std::vector<Case> cases() {
    return {{"brushed", brushedBrdf(0, brushed), 4},
            {"brushed askew", brushedBrdf(0.7, lawless), 12},
            {"twisted", twistedBrdf(), 1}};
}
constexpr std::size_t steps = 3;

/// Places of a surface and viewers at the nodes of a table, in all quarters.
struct Sight {
    Direction normal, tangent, viewer, local;  ///< local: the viewer in the frame
};
std::vector<Sight> sights(const ElevationRows& rows, std::size_t azimuths) {
    std::vector<Sight> result;
    for (const Direction& normal :
         {directionFromAngles(0.9, 2.1), directionFromAngles(2.6, -0.7)}) {
        Frame frame = frameAt(normal);
        for (const std::size_t row : {std::size_t{1}, rows.count / 2, rows.count - 2}) {
            for (int k = 0; k < 12; ++k) {
                // 30 degrees apart, or anywhere for a table without azimuths.
                const double phi = azimuths == 1 ? 0.37 + k : k * pi / 6;
                const Direction local = directionFromAngles(std::acos(rows.cosine(row)), phi);
                result.push_back({normal, frame.tangent, frame.toWorld(local), local});
            }
        }
    }
    return result;
}

/// The integral of f cos L for L = 1 + slope . w, by the nodes of f.
double linearTruth(const Brdf& brdf, const Sight& at, const Direction& slope) {
    const LobeNodes nodes = lobeNodes(brdf, at.local, 4);
    const Direction local = frameAt(at.normal).toLocal(slope);
    double sum = 0;
    for (std::size_t k = 0; k < nodes.count(); ++k)
        sum += nodes.weights[k] * nodes.z[k] * nodes.f[0][k] *
               (1 + dot(local, {nodes.x[k], nodes.y[k], nodes.z[k]}));
    return sum;
}

const Direction slope{0.3, -0.5, 0.6};
const ElevationRows rows{.count = 8};

TEST(AzimuthNodes, AreAtTheirOwnAnglesInEveryQuarter) {
    EXPECT_EQ(AzimuthNodes(Laws{.isotropic = true}, 8).count, 1u);
    const AzimuthNodes folded(brushed, 4), whole(lawless, 2);
    EXPECT_EQ(folded.count, 5u);
    EXPECT_EQ(whole.count, 8u);
    for (std::size_t k = 0; k < folded.count; ++k) {
        for (const double turn : {0.0, pi}) {
            const AzimuthNodes::Place same = folded.place(turn + folded.angle(k) + 1e-9),
                                      other = folded.place(turn - folded.angle(k) - 1e-9);
            const double expected = static_cast<double>(k);
            EXPECT_NEAR(static_cast<double>(same.first) + same.share, expected, 1e-6);
            EXPECT_NEAR(static_cast<double>(other.first) + other.share, expected, 1e-6);
            EXPECT_EQ(same.mirrored, k == 4) << k;  // beyond the quarter's end
            EXPECT_EQ(other.mirrored, k < 4) << k;
        }
    }
    for (std::size_t k = 0; k < whole.count; ++k) {
        const AzimuthNodes::Place place = whole.place(whole.angle(k) + 0.25 * 2 * pi / 8);
        EXPECT_EQ(place.first, k);
        EXPECT_EQ(place.second, (k + 1) % 8);
        EXPECT_NEAR(place.share, 0.25, 1e-12);
        EXPECT_FALSE(place.mirrored);
    }
}

TEST(AzimuthLighting, HarmonicsReflectLinearLightExactlyInEveryQuarter) {
    const std::vector<Light> lights{linearLight(slope)};
    for (const Case& one : cases()) {
        const HarmonicShading shading(fitHarmonics(one.brdf, 3, rows, steps),
                                      projectLight(lights, *bases::make("sh", 3)));
        EXPECT_EQ(shading.table().table.azimuths.count, one.azimuths) << one.name;
        for (const Sight& at : sights(rows, one.azimuths))
            EXPECT_NEAR(shading.radiance(at.normal, at.viewer, at.tangent)[0],
                        linearTruth(one.brdf, at, slope), 5e-4)
                << one.name;
    }
}

TEST(AzimuthLighting, SplitSumsKeepTheFirstMomentOfTheLobeInEveryQuarter) {
    const std::vector<Light> lights{linearLight(slope)};
    const auto nine = irradianceNine(lights);
    for (const Case& one : cases()) {
        const SplitSumTable table = fitSplitSum(one.brdf, rows, steps);
        const EnvironmentCube cube = prefilter(table, lights, 32);
        for (const Sight& at : sights(rows, one.azimuths)) {
            const double truth = linearTruth(one.brdf, at, slope);
            EXPECT_NEAR(radiance(table, cube, nine, at.normal, at.viewer, at.tangent)[0], truth,
                        5e-3 * truth)
                << one.name;
        }
    }
}

TEST(AzimuthLighting, TapsSpreadABrushedLobeAlongItsWideSide) {
    // One kernel cannot be narrow and wide.
    const SplitSumTable table = fitSplitSum(brushedBrdf(0, brushed), rows, steps);
    EXPECT_GT(table.taps, 1u);
    EXPECT_LT(table.misplaced, 0.1);
    // Seen from above, the brushed lobe is wide along the tangent: 2 p = 0.
    const auto row = table.table.row(0);
    EXPECT_GT(row[7], 0.3);
    EXPECT_NEAR(row[11], 0, 1e-3);
    // And across the view axis, where that is at a right angle to the tangent.
    const auto across = table.table.row(0, table.table.azimuths.count - 1);
    EXPECT_LT(across[7], -0.3);
}

TEST(LobeTaps, SolverKeepsBothMoments) {
    std::vector<double> t, values;
    for (int k = 1; k <= 2000; ++k) {
        t.push_back(k / 2000.0);
        values.push_back(std::exp(-4 * t.back() * t.back()));
    }
    const LobeKernel kernel(t, values);
    const LobeTaps taps(9);
    const LobeSpread spread{.sum = 0.3, .difference = 0.06, .product = -0.08};
    const double cosine = 0.85;
    const SpreadLobe lobe = SpreadSolver(kernel, taps).solve(cosine, spread);
    EXPECT_NEAR(lobe.meanCosine * taps.meanCosine(lobe.spread), cosine, 1e-9);
    const double square = kernel.moments(kernel.scaleFor(lobe.meanCosine)).meanSquare;
    EXPECT_NEAR(taps.meanSquareSine(lobe.spread) * (3 * square - 1) / 2, 0.1, 2e-3);
    EXPECT_NEAR(2 * lobe.angle, std::atan2(-0.08, 0.06), 1e-12);
    double sum = 0;
    for (const double weight : taps.weights) sum += weight;
    EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(LobeNodes, ThinnedNodesKeepTheMomentsOfTheLobe) {
    const test::FormulaBrdf brdf = brushedBrdf(0.7, lawless);
    const LobeNodes all = viewNodes(brdf, 0.5, 0.3, 80);
    const LobeNodes some = thinned(all, 4000);
    ASSERT_GT(all.count(), 2 * some.count());
    const LobeSummary a = summarise(all, 0), b = summarise(some, 0);
    EXPECT_NEAR(b.albedo[0], a.albedo[0], 2e-3 * a.albedo[0]);
    EXPECT_NEAR(b.meanCosine, a.meanCosine, 2e-3);
    EXPECT_NEAR(spreadOf(some, b).difference, spreadOf(all, a).difference, 2e-3);
}

TEST(AzimuthLighting, AskewCosinesReflectTheAlbedoUnderUniformLight) {
    const std::vector<Light> lights{uniformLight()};
    const std::vector<AreaLight> tiles = areaLights(lights, 6);
    const AzimuthNodes azimuths(brushed, steps);
    std::vector<CosineRow> table(4 * azimuths.count);
    for (CosineRow& row : table)
        row = {.even = {0.1, 0.1, 0.1},
               .rest = {0.6, 0.5, 0.4},
               .lobe = {.a = 3, .b = 2, .c = -1.5, .d = 1.2, .e = -0.6, .f = 0.4, .g = 0.7}};
    for (const Sight& at : sights({.count = 4}, azimuths.count)) {
        const Rgb lit =
            radiance(cosineTable(table, azimuths, false), tiles, at.normal, at.viewer, at.tangent);
        EXPECT_NEAR(lit[0], 0.7, 1e-9);
        EXPECT_NEAR(lit[2], 0.5, 1e-9);
    }
}

TEST(AzimuthLighting, AskewCosinesAreMirroredWithTheViewer) {
    const AzimuthNodes azimuths(brushed, steps);
    std::vector<CosineRow> table(4 * azimuths.count);
    for (CosineRow& row : table)
        row = {.rest = {1, 1, 1},
               .lobe = {.a = 3, .b = 2, .c = -1.5, .d = 1.2, .e = -0.6, .f = 0.4, .g = 0.7}};
    const CosineTable cosines = cosineTable(table, azimuths, false);
    const Direction up{0, 0, 1}, along{1, 0, 0};
    const AreaLight light{{{{-1, -1, 1}, {0, -1, 1}, {0, 0.2, 1}, {-1, 0.2, 1}}}, {1, 1, 1}};
    AreaLight image = light;
    for (Direction& corner : image.corners) corner.y = -corner.y;
    const Direction viewer = directionFromAngles(0.8, 0.5), other = directionFromAngles(0.8, -0.5);
    const double seen = radiance(cosines, {&light, 1}, up, viewer, along)[0];
    EXPECT_GT(seen, 0.01);
    EXPECT_NEAR(radiance(cosines, {&image, 1}, up, other, along)[0], seen, 1e-12);
    // Without the mirror it is another lobe.
    EXPECT_GT(std::abs(radiance(cosines, {&image, 1}, up, viewer, along)[0] - seen), 0.01);
}

}  // namespace
}  // namespace hshfit::lighting
