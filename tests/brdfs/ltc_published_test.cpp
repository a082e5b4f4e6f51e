// Our table against the published one of GGX. 22 x 22 cells are every third of 64 x 64.

#include "places.h"

#include <brdfs/catalog.h>
#include <brdfs/fit/ltc_files.h>

#include <brdfs/ltc_published.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace hshfit::brdfs {
namespace {

const std::string folder = test::sharedFolder() + "/data/tables/ltc";

class LtcPublished : public testing::Test {
protected:
    void SetUp() override {
        if (!published_.complete()) GTEST_SKIP() << folder << " has no published tables";
    }
    test::PublishedLtc published_{folder};
};

TEST_F(LtcPublished, LobesAreNoWorseAndEnergiesAgree) {
    constexpr int size = 22, step = 3;
    const LtcTable table = fitLtcTable("ggx", {.size = size});
    double magnitude = 0, fresnel = 0, ours = 0, theirs = 0;
    int cells = 0, worse = 0;
    // Column 0 is left out: there alpha is 1e-4 for us and 1e-5 for them.
    for (int column = 1; column < size; ++column) {
        const auto brdf = open(fmt::format("ggx:alpha={}", table.values[column]));
        for (int row = 0; row < size; ++row, ++cells) {
            const LtcLobe& lobe = table.cell(row, column);
            const double* energies = published_.texel(1, step * row, step * column);
            magnitude += std::abs(lobe.magnitude - energies[0]);
            fresnel += std::abs(lobe.fresnel - energies[1]);
            const Direction wo = directionFromAngles(std::acos(table.cosines[row]), 0);
            double error = HUGE_VAL;
            for (const Ltc& ltc : published_.matrices(step * row, step * column))
                if (ltc.determinant() > 0)
                    error = std::min(error, judgeLtc(*brdf, wo, ltc, lobe.ltc).error);
            ours += lobe.error;
            theirs += error;
            worse += lobe.error > 1.01 * error + 1e-6 ? 1 : 0;
        }
    }
    fmt::print(
        "{} cells: magnitude {:.5f}, Fresnel part {:.5f} mean absolute difference; cubed "
        "lobe error {:.4f}, published {:.4f}; worse in {}\n",
        cells, magnitude / cells, fresnel / cells, ours / cells, theirs / cells, worse);
    EXPECT_LT(magnitude / cells, 0.02);
    EXPECT_LT(fresnel / cells, 0.02);
    EXPECT_LT(ours, theirs);
    EXPECT_EQ(worse, 0);
}

TEST_F(LtcPublished, SphereColumnAgrees) {
    for (int row = 0; row < 64; ++row)
        for (int column = 0; column < 64; ++column)
            EXPECT_NEAR(sphereAboveHorizon(column / 31.5 - 1, row / 63.0),
                        published_.texel(1, row, column)[3], 2e-3);
}

/// Shaders that load the published files load ours.
TEST_F(LtcPublished, DdsHeaderIsTheSame) {
    LtcTable table{.spec = "ggx", .parameter = "alpha", .size = 64};
    table.values.resize(64);
    table.cosines.resize(64);
    table.cells.resize(64 * 64);
    const std::string path = testing::TempDir() + "hshfit-ltc.dds";
    for (const std::string& file : writeLtcTable(table, path)) {
        EXPECT_EQ(test::contentOfFile(file).substr(0, 128),
                  test::contentOfFile(folder + "/ltc_1.dds").substr(0, 128));
        EXPECT_EQ(test::contentOfFile(file).size(), 32896u);
        std::remove(file.c_str());
    }
}

}  // namespace
}  // namespace hshfit::brdfs
