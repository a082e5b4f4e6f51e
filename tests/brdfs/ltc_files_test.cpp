#include "places.h"

#include <brdfs/fit/ltc_files.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_picture.h>

#include <brdfs/ltc_published.h>
#include <brdfs/measured_files.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace hshfit::brdfs {
namespace {

namespace fs = std::filesystem;
using test::contentOfFile;

/// A table of made-up numbers, 3 x 3, each different.
LtcTable madeUpTable() {
    LtcTable table{.spec = "ggx:F0=1", .parameter = "alpha", .size = 3};
    table.values = {1e-4, 0.25, 1};
    table.cosines = {1, 0.75, 0.1};
    for (int k = 0; k < 9; ++k) {
        const double x = k + 1;
        table.cells.push_back({.ltc = {.a = 0.5 * x, .c = -x / 64, .b = x / 32, .d = 1 / x},
                               .magnitude = x / 16,
                               .fresnel = x / 1024,
                               .error = x / 10,
                               .misplaced = x / 20,
                               .uncertainty = 0,
                               .iterations = k,
                               .converged = true});
    }
    return table;
}

class LtcFiles : public testing::Test {
protected:
    void SetUp() override {
        std::string name = fs::temp_directory_path() / "hshfit-ltc-XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return folder_ / name; }

    /// The expected texel, derived from the table.
    static double expected(const LtcTable& table, int picture, int row, int column, int channel) {
        const LtcLobe& lobe = table.cell(row, column);
        const Ltc& ltc = lobe.ltc;
        if (picture == 0) return std::array{ltc.a, ltc.c, ltc.b, ltc.d}[channel];
        const double sphere = sphereAboveHorizon(column - 1.0, row / 2.0);
        return std::array{lobe.magnitude, lobe.fresnel, 0.0, sphere}[channel];
    }

    fs::path folder_;
};

TEST_F(LtcFiles, DdsHoldsTheTable) {
    const LtcTable table = madeUpTable();
    const auto written = writeLtcTable(table, path("t.dds"));
    ASSERT_EQ(written, (std::vector<std::string>{path("t_1.dds"), path("t_2.dds")}));
    for (int picture = 0; picture < 2; ++picture) {
        const std::string bytes = contentOfFile(written[picture]);
        ASSERT_EQ(bytes.size(), 128 + 9 * 8u);
        const auto texels = test::ddsTexels(bytes);
        for (int k = 0; k < 36; ++k) {
            const double value = expected(table, picture, k / 12, k / 4 % 3, k % 4);
            EXPECT_NEAR(texels[k], value, std::abs(value) / 2048 + 1e-7) << picture << " " << k;
        }
    }
}

TEST_F(LtcFiles, ExrHoldsTheTable) {
    const LtcTable table = madeUpTable();
    const auto written = writeLtcTable(table, path("t.exr"));
    ASSERT_EQ(written, (std::vector<std::string>{path("t_1.exr"), path("t_2.exr")}));
    const std::string channels[] = {"R", "G", "B", "A"};
    for (int picture = 0; picture < 2; ++picture) {
        const ExrPicture exr = readExrPicture(contentOfFile(written[picture]), "t", 1000);
        ASSERT_EQ(exr.width, 3u);
        ASSERT_EQ(exr.height, 3u);
        EXPECT_EQ(exr.attributes.at("hshfit:brdf"), "ggx:F0=1");
        for (int c = 0; c < 4; ++c) {
            const auto found = std::ranges::find(exr.channels, channels[c]);
            ASSERT_NE(found, exr.channels.end());
            for (int k = 0; k < 9; ++k)
                EXPECT_EQ(exr.at(k / 3, k % 3, found - exr.channels.begin()),
                          static_cast<float>(expected(table, picture, k / 3, k % 3, c)));
        }
    }
}

TEST_F(LtcFiles, JsonHoldsTheTable) {
    const LtcTable table = madeUpTable();
    ASSERT_EQ(writeLtcTable(table, path("t.json")).size(), 1u);
    const auto json = nlohmann::json::parse(contentOfFile(path("t.json")));
    EXPECT_EQ(json["format"], "hshfit-ltc");
    EXPECT_EQ(json["cosines"][1], 0.75);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            EXPECT_EQ(json["error"][row][column], table.cell(row, column).error);
            for (int c = 0; c < 4; ++c) {
                EXPECT_EQ(json["ltc_1"][row][column][c].get<float>(),
                          static_cast<float>(expected(table, 0, row, column, c)));
                EXPECT_EQ(json["ltc_2"][row][column][c].get<float>(),
                          static_cast<float>(expected(table, 1, row, column, c)));
            }
        }
    const std::string source = test::sourceFolder();
    if (std::system("/usr/bin/python3 -c 'import jsonschema' 2>/dev/null") == 0) {
        const std::string check = "/usr/bin/python3 " + source + "/tests/validate_schema.py " +
                                  source + "/docs/schemas/ltc.schema.json " + path("t.json");
        EXPECT_EQ(std::system(check.c_str()), 0);
    }
}

TEST_F(LtcFiles, NothingIsLeftOfWhatCannotBeWritten) {
    EXPECT_THROW(writeLtcTable(madeUpTable(), path("t.png")), UsageError);
    fs::create_directory(path("u_2.dds"));
    EXPECT_THROW(writeLtcTable(madeUpTable(), path("u.dds")), OutputError);
    EXPECT_TRUE(fs::is_directory(path("u_2.dds")));
    EXPECT_FALSE(fs::exists(path("u_1.dds")));
}

}  // namespace
}  // namespace hshfit::brdfs
