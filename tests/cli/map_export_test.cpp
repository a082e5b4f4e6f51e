// `export` of maps of materials, and `project` of a texel, as a user meets them.

#include "places.h"

#include <cli/program.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

class MapExport : public Cli {
protected:
    /// An 8 x 4 map of GGX, of a form.
    std::string made(const std::string& form) const {
        std::ofstream file(path("alpha.pfm"), std::ios::binary);
        file << "Pf\n8 4\n-1.0\n";
        for (int k = 0; k < 32; ++k) {
            const float v = 0.2F + 0.6F * static_cast<float>(k * 7 % 32) / 32;
            file.write(reinterpret_cast<const char*>(&v), sizeof v);
        }
        file.close();
        std::ofstream(path("d.json"))
            << R"({"format": "hshfit-svbrdf", "version": 1, "model": "ggx", "parameters": )"
               R"({"alpha": {"map": "alpha.pfm"}, "kd": [0.3, 0.2, 0.1], "ks": 0.5}})";
        const Answer answer =
            run("svbrdf " + path("d.json") + " -o " + path(form) + " --form " + form);
        EXPECT_EQ(answer.code, 0) << answer.err;
        return path(form) + "/material.json";
    }
    Json readJson(const std::string& name) const { return Json::parse(read(path(name))); }
};

class MapExportForms : public MapExport, public testing::WithParamInterface<std::string> {};

TEST_P(MapExportForms, FilesKeepTheirSchemasAndHoldTheTexels) {
    const std::string map = made(GetParam());
    const Answer answer =
        run("export " + map + " -o " + path("out") +
            " --target ktx2,exr-parts,glsl-es,glsl,hlsl,slang,wgsl,metal,osl,viewer" + " --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export_map"));
    const Json said = Json::parse(answer.out);
    for (const auto& file : said["files"]) {
        const std::string name = path("out/" + file["path"].get<std::string>());
        ASSERT_TRUE(std::filesystem::exists(name)) << name;
        if (!file.contains("sha256")) continue;
        EXPECT_EQ(std::filesystem::file_size(name), file["bytes"]);
        ASSERT_EQ(std::system(fmt::format("echo '{}  {}' | sha256sum --status -c",
                                          file["sha256"].get<std::string>(), name)
                                  .c_str()),
                  0);
    }
    EXPECT_EQ(read(path("out/material.map.ktx2")),
              read(path(std::string(GetParam()) + "/material.ktx2")));
    EXPECT_TRUE(keepsSchema(read(path("out/material.hsh.json")), "gpu_map"));
    EXPECT_TRUE(keepsSchema(read(path("out/material_test.json")), "gpu_map_test"));
}

/// The test values of an export at centres of texels are the answers of `eval` for the texel.
TEST_P(MapExportForms, ValuesAreThoseOfEval) {
    const std::string map = made(GetParam());
    ASSERT_EQ(run("export " + map + " -o " + path("out")).code, 0);
    const Json tests = readJson("out/material_test.json")["tests"];
    const Json levels = readJson("out/material.hsh.json")["map"]["levels"];
    // Angles in degrees, accurate at the pole and at the horizon.
    const auto angles = [](const Json& v) {
        const double x = v[0], y = v[1], z = v[2];
        return fmt::format("{:.17g},{:.17g}", std::atan2(std::hypot(x, y), z) * 180 / M_PI,
                           std::atan2(y, x) * 180 / M_PI);
    };
    std::size_t compared = 0;
    double largest = 0;
    for (std::size_t k = 0; k < tests.size(); k += 3) {
        const Json& test = tests[k];
        const auto level = static_cast<std::size_t>(test["lod"].get<double>());
        const auto index = [&](double at, const char* side) {
            return static_cast<int>(std::floor(at * levels[level][side].get<double>()));
        };
        const Answer answer = run(fmt::format(
            "eval {}:x={},y={},level={} --wi {} --wo {} --json", map, index(test["uv"][0], "width"),
            index(test["uv"][1], "height"), level, angles(test["wi"]), angles(test["wo"])));
        ASSERT_EQ(answer.code, 0) << answer.err;
        const Json values = Json::parse(answer.out)["values"];
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = test["value"][c];
            largest = std::max(largest, value);
            EXPECT_NEAR(values[c].get<double>(), value, 1e-6 * (1 + std::abs(value)));
            ++compared;
        }
    }
    EXPECT_EQ(compared, 72U);
    EXPECT_GT(largest, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Every, MapExportForms, testing::Values("outgoing", "low-rank", "clusters"),
                         [](const auto& row) {
                             return row.param == "low-rank" ? "low_rank" : row.param;
                         });

TEST_F(MapExport, DefaultIsTheTextureAndAShaderForBrowsers) {
    const std::string map = made("outgoing");
    const Answer answer = run("export " + map + " -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path("out")))
        names.insert(entry.path().filename().string());
    EXPECT_EQ(names, (std::set<std::string>{"material.hsh.json", "material_test.json",
                                            "material.map.ktx2", "material_hsh.es.glsl"}));
    // Valid files are kept, other options are refused, and --force makes the same bytes again.
    const std::string before = read(path("out/material.hsh.json"));
    const Answer again = run("export " + map + " -o " + path("out"));
    EXPECT_EQ(again.code, 0);
    EXPECT_NE(again.out.find("kept "), std::string::npos) << again.out;
    const Answer other = run("export " + map + " --target ktx2,wgsl -o " + path("out"));
    EXPECT_EQ(other.code, 5);
    EXPECT_NE(other.err.find("--force"), std::string::npos) << other.err;
    EXPECT_EQ(run("export " + map + " -o " + path("out") + " --force").code, 0);
    EXPECT_EQ(read(path("out/material.hsh.json")), before);
}

TEST_F(MapExport, AllLeavesOutWhatHasNoLevels) {
    const std::string map = made("clusters");
    const Answer answer = run("export " + map + " -o " + path("out") + " --target all");
    EXPECT_EQ(answer.code, 0) << answer.err;
    for (const char* left : {"dds", "tensor", "three"})
        EXPECT_NE(answer.err.find(left), std::string::npos) << left << ": " << answer.err;
    EXPECT_TRUE(std::filesystem::exists(path("out/material_viewer.html")));
    EXPECT_TRUE(std::filesystem::exists(path("out/material.shared.exr")));
}

TEST_F(MapExport, OptionsOfCoefficientsAreRefusedInOneLine) {
    const std::string map = made("low-rank");
    const auto refused = [&](const std::string& more, const std::string& part) {
        const Answer answer = run("export " + map + " -o " + path("out") + " " + more);
        EXPECT_EQ(answer.code, 2) << more << answer.err;
        EXPECT_NE(answer.err.find(part), std::string::npos) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
        EXPECT_FALSE(std::filesystem::exists(path("out")));
    };
    refused("--packing rgb", "--packing");
    refused("--sampling", "--sampling");
    refused("--target dds", "ktx2");
    refused("--target three", "three");
    refused("--target glsl --light uniform", "viewer");
    refused("--target glsl --prefix 1x", "prefix");
    refused("--target glsl --environment-order 40", "40");
    ASSERT_EQ(run("project lambert -o " + path("c.json")).code, 0);
    const Answer wrap = run("export " + path("c.json") + " -o " + path("out") + " --wrap repeat");
    EXPECT_EQ(wrap.code, 2) << wrap.err;
}

TEST_F(MapExport, ATextureThatIsCutShortIsNamed) {
    const std::string map = made("outgoing");
    std::filesystem::resize_file(path("outgoing/material.ktx2"), 3000);
    const Answer answer = run("export " + map + " -o " + path("out"));
    EXPECT_EQ(answer.code, 3);
    EXPECT_NE(answer.err.find("material.ktx2"), std::string::npos) << answer.err;
    EXPECT_FALSE(std::filesystem::exists(path("out")));
}

/// The texel has these coefficients already: projected to the same basis and map they come back.
TEST_F(MapExport, ProjectOpensATexel) {
    const std::string texel = made("outgoing") + ":x=3,y=1,level=1";
    const Answer answer =
        run("project " + texel + " -o " + path("p.json") + " --order 4 --outgoing 8");
    ASSERT_EQ(answer.code, 0) << answer.err;
    for (const char* pair : {"--wi 30,180 --wo 20,0", "--wi 10,40 --wo 60,0"}) {
        const Answer own = run("eval " + texel + " " + pair + " --json");
        const Answer projected = run("eval " + path("p.json") + " " + pair + " --json");
        const Json a = Json::parse(own.out)["values"], b = Json::parse(projected.out)["values"];
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(a[c].get<double>(), b[c].get<double>(), 2e-4);
    }
    const Answer beyond =
        run("project " + path("outgoing/material.json:x=8") + " -o " + path("q.json"));
    EXPECT_EQ(beyond.code, 2);
    EXPECT_NE(beyond.err.find("(8, 0)"), std::string::npos) << beyond.err;
}

}  // namespace
