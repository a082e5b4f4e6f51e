// Integrals over one hemisphere of tables with steps, by wi and by wo, against sums over cells that
// are derived here; and the repair that follows from them.

#include <brdfs/catalog.h>
#include <brdfs/repair.h>
#include <hshfit/brdf/channel_view.h>
#include <hshfit/pictures/sphere_albedo.h>
#include <hshfit/projection/albedo.h>

#include "bsdf_xml_files.h"

#include <lib/formula_brdf.h>

namespace hshfit {
namespace {

using namespace test;

constexpr const char* full = "LBNL/Klems Full";

std::unique_ptr<Brdf> klems(const char* name, const std::vector<KlemsRing>& rings,
                            const std::function<double(int, int)>& value) {
    return openBytes(bsdfXml(
        "Columns", "", blockXml("Reflection Front", matrixText(patchesOf(rings), value), name)));
}

/// The BRDF, half as bright, through a wrapper.
std::unique_ptr<Brdf> asGreyHalf(std::unique_ptr<Brdf> brdf) {
    ChannelView::Look look{
        .name = "half", .channels = Channels::grey(), .laws = brdf->laws(), .weights = {{0.5}}};
    return std::make_unique<ChannelView>(std::move(brdf), std::move(look));
}

int ringOf(const std::vector<KlemsRing>& rings, int patch) {
    int ring = 0;
    for (; patch >= rings[static_cast<std::size_t>(ring)].azimuths; ++ring)
        patch -= rings[static_cast<std::size_t>(ring)].azimuths;
    return ring;
}

/// The share that each ring reflects, all of it into the mirror image of the patch.
constexpr double shares[] = {0.05, 0.05, 0.05, 0.06, 0.07, 0.09, 0.14, 0.26, 0.60};

std::unique_ptr<Brdf> mirrorLike(double atRing7 = shares[7]) {
    const std::vector<double> angles = projectedSolidAngles(klemsFull);
    return klems(full, klemsFull, [&](int o, int i) {
        const int ring = ringOf(klemsFull, i);
        const double share = ring == 7 ? atRing7 : shares[ring];
        return o == i ? share / angles[static_cast<std::size_t>(i)] : 0;
    });
}

// Values are written with six digits.
TEST(StepAlbedo, OnePatchThatReflectsIsFoundAtEveryAzimuth) {
    const auto brdf = mirrorLike();
    const double thetas[] = {2, 10, 30, 60, 70, 82};
    for (const double theta : thetas) {
        for (const double phi : {0.0, 7.0, 45.0, 90.0, 200.0}) {
            const Direction wo = directionFromAngles(radians(theta), radians(phi));
            const int ring = ringOf(klemsFull, patchAt(klemsFull, wo.x, wo.y, wo.z));
            const AlbedoEstimate found = estimateAlbedo(*brdf, wo, {});
            EXPECT_TRUE(found.converged);
            EXPECT_NEAR(found.values[0], shares[ring], 1e-5) << theta << " " << phi;
            EXPECT_LE(found.error, 1e-9);
        }
    }
}

/// Entries of the table of pictures are every 5 degrees; these are inside of patches.
TEST(StepAlbedo, DomesOfPicturesFindTheOnePatchThatReflects) {
    const auto brdf = mirrorLike();
    using Detail = AlbedoTable::Detail;
    for (const Detail detail : {Detail::fine, Detail::coarse}) {
        const AlbedoTable table(*brdf, detail);
        EXPECT_LE(table.error(), 1e-9);
        for (const double theta : {10, 20, 30, 40, 50, 60, 70, 80}) {
            for (const double phi : {0.0, 22.5, 45.0, 90.0, 180.0}) {
                const Direction wo = directionFromAngles(radians(theta), radians(phi));
                const int ring = ringOf(klemsFull, patchAt(klemsFull, wo.x, wo.y, wo.z));
                double albedo = 0;
                table.at(wo, {&albedo, 1});
                EXPECT_NEAR(albedo, shares[ring], 1e-5) << theta << " " << phi;
            }
        }
    }
}

TEST(StepAlbedo, BothIntegralsOfAnyMatrixAreSumsOverItsPatches) {
    const std::pair<const char*, std::vector<KlemsRing>> bases[] = {
        {full, klemsFull}, {"LBNL/Klems Half", klemsHalf}, {"LBNL/Klems Quarter", klemsQuarter}};
    std::mt19937 random(3);
    for (const auto& [name, rings] : bases) {
        const std::vector<double> angles = projectedSolidAngles(rings);
        const int patches = patchesOf(rings);
        // One value in twenty is not 0.
        std::vector<double> matrix(static_cast<std::size_t>(patches * patches));
        for (double& value : matrix)
            value = random() % 20 == 0 ? static_cast<int>(random() % 1000) / 500.0 : 0;
        const auto at = [&](int o, int i) {
            return matrix[static_cast<std::size_t>(o * patches + i)];
        };
        const auto brdf = klems(name, rings, at);
        const auto grey = asGreyHalf(klems(name, rings, at));
        for (int k = 0; k < 30; ++k) {
            const Direction w = randomDirection(random, 0.05);
            const int o = patchAt(rings, -w.x, w.y, w.z), i = patchAt(rings, w.x, -w.y, w.z);
            double albedo = 0, reflectance = 0;
            for (int p = 0; p < patches; ++p) {
                albedo += at(o, p) * angles[static_cast<std::size_t>(p)];
                reflectance += at(p, i) * angles[static_cast<std::size_t>(p)];
            }
            EXPECT_NEAR(directionalAlbedo(*brdf, w)[0], albedo, 1e-9 * (1 + albedo)) << name;
            EXPECT_NEAR(directionalReflectance(*brdf, w)[0], reflectance, 1e-9 * (1 + reflectance))
                << name;
            EXPECT_NEAR(directionalReflectance(*grey, w)[0], reflectance / 2,
                        1e-9 * (1 + reflectance))
                << "seen through another BRDF, " << name;
        }
    }
}

/// 8 x 8 by 8 x 8 cells, most of them black: [a][b] of the incident square, [c][d] of the outgoing.
struct Cells {
    std::vector<double> values = std::vector<double>(4096);
    double& at(int a, int b, int c, int d) {
        return values[static_cast<std::size_t>(((a * 8 + b) * 8 + c) * 8 + d)];
    }
    std::unique_ptr<Brdf> open() const {
        std::string text = "{";
        for (const double value : values) text += ' ' + std::to_string(value);
        return openBytes(bsdfXml("TensorTree4", "",
                                 blockXml("Reflection Front", text + " }", "LBNL/Shirley-Chiu")));
    }
};

TEST(StepAlbedo, BothIntegralsOfATreeAreSumsOverItsCells) {
    std::mt19937 random(9);
    Cells cells;
    for (double& value : cells.values)
        value = random() % 40 == 0 ? static_cast<int>(random() % 64) / 16.0 : 0;
    const auto tree = cells.open();
    for (int k = 0; k < 40; ++k) {
        const Direction w = randomDirection(random, 0.02);
        const auto [a, b] = shirleyChiu(w.x, -w.y);  // light goes to -wi; the front has -x
        const auto [c, d] = shirleyChiu(-w.x, w.y);
        double albedo = 0, reflectance = 0;
        const auto cell = [](double u) { return static_cast<int>(u * 8); };
        for (int p = 0; p < 8; ++p) {
            for (int q = 0; q < 8; ++q) {
                albedo += pi / 64 * cells.at(p, q, cell(c), cell(d));
                reflectance += pi / 64 * cells.at(cell(a), cell(b), p, q);
            }
        }
        const AlbedoEstimate found = estimateAlbedo(*tree, w, {});
        EXPECT_NEAR(found.values[0], albedo, 1e-12);
        EXPECT_LE(found.error, 1e-12);
        EXPECT_NEAR(directionalReflectance(*tree, w)[0], reflectance, 1e-12);
    }
}

TEST(StepAlbedo, DomesOfPicturesSumOverTheCellsOfATree) {
    std::mt19937 random(11);
    Cells cells;
    for (double& value : cells.values)
        value = random() % 40 == 0 ? static_cast<int>(random() % 64) / 16.0 : 0;
    const AlbedoTable table(*cells.open());
    const Direction wo = directionFromAngles(radians(40), radians(22.5));  // an entry
    const auto [c, d] = shirleyChiu(-wo.x, wo.y);
    const auto cell = [](double u) { return static_cast<int>(u * 8); };
    double expected = 0, albedo = 0;
    for (int p = 0; p < 8; ++p) {
        for (int q = 0; q < 8; ++q) expected += pi / 64 * cells.at(p, q, cell(c), cell(d));
    }
    table.at(wo, {&albedo, 1});
    EXPECT_NEAR(albedo, expected, 1e-12);
}

// Rings of wi in 8 steps of sin(theta_i), and wo seen from wi: dense sums over directions.
TEST(StepAlbedo, IntegralsOfAnIsotropicTree) {
    std::mt19937 random(5);
    std::string text = "{";
    for (int k = 0; k < 512; ++k)
        text +=
            ' ' + std::to_string(random() % 10 == 0 ? static_cast<int>(random() % 64) / 16.0 : 0);
    const auto tree = openBytes(
        bsdfXml("TensorTree3", "", blockXml("Reflection Front", text + " }", "LBNL/Shirley-Chiu")));
    const std::vector<Direction> grid = projectedGrid(700, 720);
    for (const double theta : {0.1, 0.7, 1.3}) {
        const Direction w = directionFromAngles(theta, 0.4);
        double albedo = 0;
        for (const Direction& wi : grid) albedo += valueOf(*tree, wi, w);
        albedo *= pi / static_cast<double>(grid.size());
        EXPECT_NEAR(directionalAlbedo(*tree, w, 1e-3)[0], albedo, 4e-3 * albedo);
        const double reflectance = reflectanceFrom(*tree, w, grid);
        EXPECT_NEAR(directionalReflectance(*tree, w)[0], reflectance, 4e-3 * reflectance);
    }
}

// f = a(wi) b(wo): the reflectance is a(wi) times the integral of b, the albedo b(wo) times the
// integral of a. With a = 1 + z and b = z^2 / pi they are (1 + z) / 2 and 5/3 z^2.
TEST(StepAlbedo, ReflectanceIsOverWoAndAlbedoOverWi) {
    const FormulaBrdf skew(
        [](const Direction& wi, const Direction& wo) { return (1 + wi.z) * wo.z * wo.z / pi; });
    for (const double z : {1.0, 0.6, 0.2}) {
        const Direction w{0, std::sqrt(1 - z * z), z};
        EXPECT_NEAR(directionalReflectance(skew, w)[0], (1 + z) / 2, 1e-4);
        EXPECT_NEAR(directionalAlbedo(skew, w)[0], 5.0 / 3 * z * z, 2e-4);
    }
    const Health health = examine(skew);
    EXPECT_NEAR(health.largestReflectance(), 1, 2e-3);
    EXPECT_NEAR(health.largestAlbedo(), 5.0 / 3, 4e-3);
    EXPECT_FALSE(health.createsEnergy());
    const auto energy = brdfs::repairs().back();
    EXPECT_EQ(energy.name, "energy");
    EXPECT_EQ(energy.reason(skew, health), "");
    const FormulaBrdf exchanged(
        [](const Direction& wi, const Direction& wo) { return (1 + wo.z) * wi.z * wi.z / pi; });
    EXPECT_TRUE(examine(exchanged).createsEnergy());
    EXPECT_NE(energy.reason(exchanged, examine(exchanged)).find("reflectance is 1.66"),
              std::string::npos);
}

// f is linear in ks: a dark sample has the relative error of a bright one.
TEST(StepAlbedo, DarkSamplesHaveRelativeErrors) {
    const auto bright = brdfs::open("ggx:alpha=0.05,ks=1");
    const auto dark = brdfs::open("ggx:alpha=0.05,ks=1e-6");
    for (const double theta : {0.0, 50.0, 80.0, 87.0}) {
        const Direction wo = directionFromAngles(radians(theta), 0);
        const double expected = directionalAlbedo(*bright, wo, 1e-8)[0];
        EXPECT_NEAR(directionalAlbedo(*dark, wo)[0], 1e-6 * expected, 2e-4 * 1e-6 * expected);
    }
}

TEST(StepAlbedo, MatricesThatReflectTooMuchAreToldByTheLightThatArrives) {
    const std::vector<double> angles = projectedSolidAngles(klemsQuarter);
    // Light at the normal comes back one and a half times, evenly.
    const auto creates = klems("LBNL/Klems Quarter", klemsQuarter,
                               [](int, int i) { return i == 0 ? 1.5 / pi : 0.0; });
    EXPECT_FALSE(creates->laws().energyConserving);
    // Light from everywhere goes to one patch, which is as bright as three white surfaces.
    const auto gathers = klems("LBNL/Klems Quarter", klemsQuarter,
                               [&](int o, int) { return o == 0 ? 0.07 / angles[0] : 0.0; });
    EXPECT_TRUE(gathers->laws().energyConserving);
    EXPECT_GT(directionalAlbedo(*gathers, {0, 0, 1})[0], 2.8);
    Cells cells;
    for (int c = 0; c < 8; ++c)
        for (int d = 0; d < 8; ++d) cells.at(3, 4, c, d) = 0.35;
    EXPECT_FALSE(cells.open()->laws().energyConserving);
    Cells dim;
    for (int a = 0; a < 8; ++a)
        for (int b = 0; b < 8; ++b) dim.at(a, b, 3, 4) = 1;
    EXPECT_TRUE(dim.open()->laws().energyConserving);
}

TEST(StepAlbedo, EnergyIsRepairedPatchByPatch) {
    const auto repaired = brdfs::repaired(mirrorLike(1.4), "energy");
    EXPECT_TRUE(repaired->laws().energyConserving);
    std::mt19937 random(2);
    for (int k = 0; k < 60; ++k) {
        const Direction w = randomDirection(random, 0.02);
        const int ring = ringOf(klemsFull, patchAt(klemsFull, w.x, -w.y, w.z));
        const double expected = ring == 7 ? 1 : shares[ring];
        EXPECT_NEAR(directionalReflectance(*repaired, w)[0], expected, 1e-5);
    }
    Cells cells;
    for (int c = 0; c < 8; ++c)
        for (int d = 0; d < 8; ++d) cells.at(3, 4, c, d) = 0.5;
    const auto tree = brdfs::repaired(cells.open(), "energy");
    for (int k = 0; k < 200; ++k)
        EXPECT_LE(directionalReflectance(*tree, randomDirection(random, 0.02))[0], 1 + 1e-9);
}

}  // namespace
}  // namespace hshfit
