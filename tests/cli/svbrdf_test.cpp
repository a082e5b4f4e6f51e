// `svbrdf` as a user meets it: texels against `project` of their BRDFs, levels against means.

#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

class Svbrdf : public Cli {
protected:
    /// A grey PFM picture: rows from the bottom to the top.
    void writeMap(const std::string& name, int width, int height, auto value) const {
        std::ofstream file(path(name), std::ios::binary);
        file << "Pf\n" << width << ' ' << height << "\n-1.0\n";
        for (int y = height; y-- > 0;) {
            for (int x = 0; x < width; ++x) {
                const float v = value(x, y);
                file.write(reinterpret_cast<const char*>(&v), sizeof v);
            }
        }
    }
    void describe(const std::string& model, const Json& parameters) const {
        std::ofstream(path("d.json")) << Json{{"format", "hshfit-svbrdf"},
                                              {"version", 1},
                                              {"model", model},
                                              {"parameters", parameters}};
    }
    Answer made(const std::string& more) const {
        return run("svbrdf " + path("d.json") + " --json " + more);
    }
    /// f of a texel at some pairs.
    std::vector<double> values(const std::string& texel) const {
        std::vector<double> all;
        for (const char* pair : {"--wi 30,180 --wo 20,0", "--wi 10,40 --wo 60,0"}) {
            const Answer answer = run("eval " + texel + " " + pair + " --json");
            EXPECT_EQ(answer.code, 0) << answer.err;
            const Json document = Json::parse(answer.out);
            for (const auto& value : document["values"]) all.push_back(value);
        }
        return all;
    }
    std::string bytes(const std::string& file) const {
        std::ifstream stream(path(file), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
};

struct Case {
    std::string name, model;
    std::vector<std::string> parameters;
    std::vector<double> low, high;
    std::string outgoing;
    std::size_t lobes;
};

class SvbrdfModels : public Svbrdf, public testing::WithParamInterface<Case> {};

/// f at the outgoing directions of the map, by the texel and by the projected BRDF, to the
/// tolerance of the grid of lobes.
TEST_P(SvbrdfModels, TexelsAreTheProjectionsOfTheirBrdfs) {
    const Case& test = GetParam();
    constexpr int side = 4;
    Json parameters;
    const auto valueAt = [&](std::size_t k, int x, int y) {
        const double share =
            std::fmod(0.13 + 0.29 * x + 0.41 * y + 0.37 * static_cast<double>(k), 1);
        return static_cast<float>(test.low[k] + share * (test.high[k] - test.low[k]));
    };
    for (std::size_t k = 0; k < test.parameters.size(); ++k) {
        writeMap(test.parameters[k] + ".pfm", side, side,
                 [&](int x, int y) { return valueAt(k, x, y); });
        parameters[test.parameters[k]] = {{"map", test.parameters[k] + ".pfm"}};
    }
    describe(test.model, parameters);
    const Answer answer = made("--force -o " + path("out") +
                               " --precision float32 --tolerance 1e-4 --outgoing " + test.outgoing);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "svbrdf"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["lobes"].size(), test.lobes) << json["lobes"];
    EXPECT_LE(json["table"]["error"], 1e-4);
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(3, 1), std::pair(2, 3)}) {
        std::string spec = test.model;
        for (std::size_t k = 0; k < test.parameters.size(); ++k) {
            spec += fmt::format("{}{}={:.9g}", k == 0 ? ':' : ',', test.parameters[k],
                                static_cast<double>(valueAt(k, x, y)));
        }
        ASSERT_EQ(run("project '" + spec + "' --force -o " + path("p.json") +
                      " --order 4 --outgoing " + test.outgoing)
                      .code,
                  0);
        const std::vector<double> texel =
            values(path("out/material.json") + fmt::format(":x={},y={}", x, y));
        const std::vector<double> exact = values(path("p.json"));
        ASSERT_EQ(texel.size(), exact.size());
        double scale = 0;
        for (const double value : exact) scale = std::max(scale, std::abs(value));
        for (std::size_t k = 0; k < exact.size(); ++k)
            EXPECT_NEAR(texel[k], exact[k], 2e-3 * scale) << spec << ' ' << k;
    }
}

INSTANTIATE_TEST_SUITE_P(
    Every, SvbrdfModels,
    testing::Values(
        Case{"ggx", "ggx", {"kd", "ks", "alpha"}, {0, 0, 0.05}, {0.8, 0.2, 0.9}, "8", 2},
        Case{"gltf",
             "gltf-pbr",
             {"baseColorFactor", "metallicFactor", "roughnessFactor"},
             {0, 0, 0.2},
             {1, 1, 1},
             "8",
             4},
        Case{"phong", "phong", {"ks", "exponent"}, {0.1, 1}, {1, 100}, "5", 1},
        Case{"oren_nayar", "oren-nayar", {"kd", "sigma"}, {0.1, 0}, {1, 60}, "8", 1},
        Case{"ward", "ward", {"kd", "ax", "ay"}, {0, 0.1, 0.15}, {1, 0.5, 0.6}, "6x6", 2}),
    [](const auto& row) { return row.param.name; });

/// Values of two materials, a checkerboard, and their mean in level 1.
TEST_F(Svbrdf, MapsAreDescribedAndNameTheirTexel) {
    writeMap("kd.pfm", 8, 4, [](int x, int) { return 0.1F + 0.1F * static_cast<float>(x); });
    describe("lambert", {{"kd", {{"map", "kd.pfm"}}}});
    ASSERT_EQ(made("-o " + path("out")).code, 0);
    const std::string map = path("out/material.json");
    ASSERT_EQ(run("export " + map + " -o " + path("gpu")).code, 0);
    for (const std::string& file : {map, path("gpu/material.hsh.json")}) {
        const Answer info = run("info --json " + file);
        ASSERT_EQ(info.code, 0) << info.err;
        EXPECT_TRUE(keepsSchema(info.out, "info"));
        const Json facts = Json::parse(info.out)["map"];
        EXPECT_EQ(facts["form"], "outgoing");
        ASSERT_EQ(facts["levels"].size(), 4U);  // 8, 4, 2, 1
        EXPECT_EQ(facts["levels"][0], Json({{"width", 8}, {"height", 4}}));
        EXPECT_EQ(facts["levels"][3], Json({{"width", 1}, {"height", 1}}));
        const char* texels = file == map ? "out/material.ktx2" : "gpu/material.map.ktx2";
        EXPECT_EQ(facts["bytes"], std::filesystem::file_size(path(texels)));
        const Answer near = run("info --json " + std::filesystem::relative(file).string());
        EXPECT_EQ(Json::parse(near.out)["map"], facts);
        EXPECT_NE(run("info " + file).out.find("8 x 4 texels, 4 levels"), std::string::npos);
        const std::string remark = "texel 0,0 of level 0; :x=…,y=… names others";
        const std::string pair = " --wi 30,0 --wo 0,0";
        EXPECT_NE(run("eval " + file + pair).err.find(remark), std::string::npos);
        EXPECT_EQ(run("eval " + file + ":x=0,y=0" + pair).err, "");
        EXPECT_NE(run("compare lambert " + file).err.find(remark), std::string::npos);
        EXPECT_NE(run("eval " + file + ":level=1" + pair).err.find("texel 0,0 of level 1"),
                  std::string::npos);
    }
}

TEST_F(Svbrdf, TheWholeTimeAndItsPartsAreStated) {
    writeMap("kd.pfm", 8, 4, [](int x, int) { return 0.1F + 0.1F * static_cast<float>(x); });
    describe("lambert", {{"kd", {{"map", "kd.pfm"}}}});
    const Answer text = run("svbrdf " + path("d.json") + " -o " + path("out"));
    ASSERT_EQ(text.code, 0) << text.err;
    EXPECT_NE(text.out.find(" s in all: "), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("measuring of forms"), std::string::npos) << text.out;
    const Answer timed = made("--force -o " + path("again"));
    const Json seconds = Json::parse(timed.out)["seconds"];
    EXPECT_GE(seconds["total"].get<double>(),
              seconds["preparation"].get<double>() + seconds["writing"].get<double>());
    EXPECT_TRUE(keepsSchema(timed.out, "svbrdf"));
}

TEST_F(Svbrdf, LevelsAreMeansOfReflectance) {
    writeMap("alpha.pfm", 4, 2, [](int x, int y) { return (x + y) % 2 == 0 ? 0.1F : 0.7F; });
    describe("ggx", {{"alpha", {{"map", "alpha.pfm"}}}, {"ks", {0.9, 0.5, 0.1}}});
    const Answer answer = made("--force -o " + path("out") + " --precision float32");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json levels = Json::parse(answer.out)["levels"];
    ASSERT_EQ(levels.size(), 3);
    EXPECT_EQ(levels[2]["width"], 1);
    const std::string map = path("out/material.json");
    const std::vector<double> a = values(map + ":x=0,y=0"), b = values(map + ":x=1,y=0");
    for (const char* texel : {":x=0,level=1", ":x=1,level=1", ":level=2"}) {
        const std::vector<double> mean = values(map + texel);
        ASSERT_EQ(mean.size(), a.size());
        for (std::size_t k = 0; k < a.size(); ++k)
            EXPECT_NEAR(mean[k], (a[k] + b[k]) / 2, 1e-5 * (std::abs(a[k]) + std::abs(b[k])));
    }
    // The parameters' mean is another material.
    EXPECT_GT(levels[1]["against_samples"]["parameters"]["mean"], 0.1);
    EXPECT_LT(levels[1]["against_samples"]["stored"]["maximum"], 1e-6);
}

TEST_F(Svbrdf, BytesDoNotDependOnThreadsOrMemory) {
    writeMap("alpha.pfm", 64, 1024, [](int x, int y) {
        return 0.3F + 0.2F * static_cast<float>(std::sin(x * 0.7) * std::cos(y * 0.3));
    });
    describe("ggx", {{"alpha", {{"map", "alpha.pfm"}}}});
    for (const std::string form : {"outgoing", "low-rank", "clusters --clusters 32"}) {
        const std::string more = " --force --form " + form;
        ASSERT_EQ(made("-o " + path("a") + more + " --threads 1 --memory 16").code, 0);
        ASSERT_EQ(made("-o " + path("b") + more + " --threads 3").code, 0);
        for (const char* file : {"material.ktx2", "material.json", "errors.png"}) {
            EXPECT_EQ(bytes(std::string("a/") + file), bytes(std::string("b/") + file)) << form;
        }
    }
}

/// The rest is orthogonal to the kept shapes: energies of the plain and the low-rank texel differ
/// by the square of the stated error.
TEST_F(Svbrdf, StatedErrorsAreThoseOfTheTexels) {
    writeMap("alpha.pfm", 6, 6,
             [](int x, int y) { return 0.1F + 0.02F * static_cast<float>(x + 6 * y); });
    describe("ggx", {{"alpha", {{"map", "alpha.pfm"}}}});
    ASSERT_EQ(made("--force -o " + path("plain") + " --precision float32").code, 0);
    const Answer answer =
        made("--force -o " + path("low") + " --form low-rank --rank 2 --precision float32");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json level = Json::parse(answer.out)["levels"][0]["error"];
    const double stated = level["maximum"];
    double worst = 0;
    int where = 0;
    for (int texel = 0; texel < 36; ++texel) {
        const auto energy = [&](const char* folder) -> double {
            const Answer info = run("info " + path(folder) + "/material.json" +
                                    fmt::format(":x={},y={} --json", texel % 6, texel / 6));
            return Json::parse(info.out)["facts"]["energy"];
        };
        const double error = std::sqrt(std::max(0.0, 1 - energy("low") / energy("plain")));
        if (error > worst) worst = error, where = texel;
    }
    EXPECT_GT(stated, 1e-3);
    EXPECT_NEAR(worst, stated, 0.02 * stated);
    EXPECT_EQ(level["column"], where % 6);
    EXPECT_EQ(level["row"], where / 6);
}

/// Another reader's numbers of a texel, summed by hand: at the pole f is the sum of c_{l,0}
/// sqrt((2 l + 1) / (2 pi)), since P_l(1) = 1.
TEST_F(Svbrdf, KtxParseFindsTheLevels) {
    const std::string tests = hshfit::test::sourceFolder() + "/tests/";
    if (!std::filesystem::exists(tests + "gpu/node_modules/ktx-parse"))
        GTEST_SKIP() << "no ktx-parse (npm ci in tests/gpu)";
    writeMap("alpha.pfm", 8, 4,
             [](int x, int y) { return 0.2F + 0.02F * static_cast<float>(x * y); });
    describe("ggx", {{"alpha", {{"map", "alpha.pfm"}}}, {"kd", 0.3}});
    ASSERT_EQ(made("-o " + path("out")).code, 0);
    const std::string command = "node " + tests + "cli/read_levels.mjs " +
                                path("out/material.ktx2") + " 1 3 1 >" + path("said");
    ASSERT_EQ(std::system(command.c_str()), 0);
    const Json said = Json::parse(bytes("said"));
    EXPECT_EQ(said["vkFormat"], 97);  // VK_FORMAT_R16G16B16A16_SFLOAT
    EXPECT_EQ(said["width"], 8);
    EXPECT_EQ(said["height"], 4);
    // 8 elevations x ceil(10 / 4) layers x 8 bytes, of 8 x 4, 4 x 2, 2 x 1 and 1 x 1 texels
    EXPECT_EQ(said["bytes"], Json({32 * 192, 8 * 192, 2 * 192, 192}));
    double f = 0;
    const int zonal[] = {0, 1, 3, 6};  // lanes of m = 0 among m >= 0
    for (int l = 0; l < 4; ++l)
        f += said["numbers"][zonal[l]].get<double>() * std::sqrt((2 * l + 1) / (2 * M_PI));
    const Answer answer =
        run("eval " + path("out/material.json:x=3,y=1,level=1") + " --wi 0,0 --wo 0,0 --json");
    EXPECT_NEAR(Json::parse(answer.out)["values"][0], f, 1e-6);
}

/// Two materials: each texel is the halfway form that `project` gives for its material, which has
/// the narrow lobe that four bands have not. A texel of level 1 is the form for the mean of both.
TEST_F(Svbrdf, HalfwayMaterialsAreThoseOfTheTexels) {
    writeMap("alpha.pfm", 4, 2, [](int x, int) { return x % 2 == 0 ? 0.1F : 0.5F; });
    describe("ggx", {{"alpha", {{"map", "alpha.pfm"}}}, {"kd", 0.2}, {"ks", 0.5}});
    const Answer answer =
        made("-o " + path("out") + " --form halfway --clusters 2 --halfway 6,3,2");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "svbrdf"));
    const Json said = Json::parse(answer.out), choices = said["choices"];
    const auto logOf = [](const Json& choice) -> double {
        return choice["against_brdfs"]["log_error"]["mean"];
    };
    EXPECT_EQ(choices.back()["form"], "halfway");
    EXPECT_LT(logOf(choices.back()), 0.5 * logOf(choices.front()));
    EXPECT_LT(logOf(said["levels"][2]), 0.5 * logOf(choices.front()));
    const std::string narrow = "ggx:kd=0.2,ks=0.5,alpha=0.1", wide = "ggx:kd=0.2,ks=0.5,alpha=0.5";
    const std::pair<std::string, std::string> texels[] = {
        {narrow, ":x=2,y=1"},
        {wide, ":x=1,y=1"},
        {fmt::format("0.5 * {} + 0.5 * {}", narrow, wide), ":x=1,y=0,level=1"}};
    for (const auto& [spec, place] : texels) {
        ASSERT_EQ(run(fmt::format("project '{}' -o {} --force --form halfway --halfway 6,3,2 "
                                  "--precision half --reciprocal",
                                  spec, path("p.json")))
                      .code,
                  0);
        const auto texel = values(path("out/material.json") + place);
        const auto exact = values(path("p.json"));
        ASSERT_EQ(texel.size(), exact.size());
        for (std::size_t k = 0; k < exact.size(); ++k)
            EXPECT_NEAR(texel[k], exact[k], 1e-3 * (1 + exact[k])) << place;
    }
}

TEST_F(Svbrdf, HalfwayMapsAreRefusedWhereTheyHaveNoForm) {
    writeMap("alpha.pfm", 2, 2, [](int x, int) { return x == 0 ? 0.2F : 0.5F; });
    describe("ggx", {{"alpha", {{"map", "alpha.pfm"}}}});
    EXPECT_EQ(made("-o " + path("c") + " --form halfway --cosine").code, 2);
    EXPECT_EQ(made("-o " + path("c") + " --form clusters --halfway 3,2,1").code, 2);
    ASSERT_EQ(made("-o " + path("out") + " --form halfway --clusters 2 --halfway 3,2,1").code, 0);
    const Answer refused = run("export " + path("out/material.json") + " -o " + path("e"));
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("material_0000.json"), std::string::npos) << refused.err;
    EXPECT_FALSE(std::filesystem::exists(path("e")));
    EXPECT_EQ(run("export " + path("out/material_0000.json") + " -o " + path("e") +
                  " --target glsl --no-error")
                  .code,
              0);
    std::filesystem::remove(path("out/material_0001.json"));
    int gone = 0;
    for (const int x : {0, 1})
        gone += run("eval " + path("out/material.json") + fmt::format(":x={} --wi 0,0 --wo 0,0", x))
                    .code == 3;
    EXPECT_EQ(gone, 1);
}

// No texel was projected in the form halfway: it is advice, not an answer.
TEST_F(Svbrdf, AFormThatWasNotTriedIsToTry) {
    writeMap("ks.pfm", 2, 2, [](int x, int) { return x == 0 ? 0.2F : 0.5F; });
    describe("ggx", {{"alpha", 0.01}, {"ks", {{"map", "ks.pfm"}}}});
    const Answer poor = made("-o " + path("out") + " --order 3");
    ASSERT_EQ(poor.code, 0) << poor.err;
    const Json captured = Json::parse(poor.out)["captured"];
    EXPECT_FALSE(captured.contains("better")) << captured;
    EXPECT_EQ(captured.value("to_try", ""),
              "hshfit svbrdf " + path("d.json") + " -o " + path("out") + " --force --form halfway");
    EXPECT_NE(run("svbrdf " + path("d.json") + " -o " + path("out") + " --order 3 --force")
                  .out.find(": poor; to try: hshfit"),
              std::string::npos);
}

TEST_F(Svbrdf, TheBetterCallNamesAnOrderThatCapturesEnough) {
    writeMap("ks.pfm", 2, 2, [](int x, int) { return x == 0 ? 0.2F : 0.5F; });
    describe("phong", {{"exponent", 12}, {"ks", {{"map", "ks.pfm"}}}});
    const Answer poor = made("-o " + path("out") + " --order 3");
    ASSERT_EQ(poor.code, 0) << poor.err;
    const Json captured = Json::parse(poor.out)["captured"];
    ASSERT_LT(captured["least"], 0.9);
    const std::string better = captured["better"];
    ASSERT_TRUE(better.starts_with("hshfit svbrdf ")) << better;
    const Answer good = run(better.substr(7) + " --json");
    ASSERT_EQ(good.code, 0) << good.err;
    EXPECT_GE(Json::parse(good.out)["captured"]["least"], 0.9) << better;
    EXPECT_FALSE(Json::parse(good.out)["captured"].contains("better"));
}

/// The files of a map are one set: none stays of a set that is replaced, one that was taken away is
/// made again, and one that was changed is no longer valid.
TEST_F(Svbrdf, FilesOfAMapAreOneSet) {
    writeMap("kd.pfm", 2, 2, [](int x, int) { return x == 0 ? 0.2F : 0.5F; });
    describe("lambert", {{"kd", {{"map", "kd.pfm"}}}});
    const std::string halfway =
        "-o " + path("out") + " --form halfway --clusters 2 --halfway 3,2,1";
    ASSERT_EQ(made(halfway).code, 0);
    ASSERT_TRUE(std::filesystem::exists(path("out/material_0001.json")));
    const Answer kept = made(halfway);
    EXPECT_EQ(kept.code, 0);
    EXPECT_TRUE(keepsSchema(kept.out, "kept")) << kept.out;

    const std::string picture = bytes("out/errors.png");
    std::filesystem::remove(path("out/errors.png"));
    EXPECT_EQ(made(halfway).code, 0);
    EXPECT_EQ(bytes("out/errors.png"), picture);

    for (const char* name : {"out/material.ktx2", "out/material_0000.json"}) {
        const std::string whole = bytes(name);
        std::ofstream(path(name), std::ios::binary) << whole.substr(0, whole.size() - 1) << '?';
        const Answer refused = made(halfway);
        EXPECT_EQ(refused.code, 5) << refused.out;
        EXPECT_NE(refused.err.find("was changed after it was made"), std::string::npos);
        EXPECT_EQ(made(halfway + " --force").code, 0);
        EXPECT_EQ(bytes(name), whole);
    }

    EXPECT_EQ(made("-o " + path("out")).code, 5);
    ASSERT_EQ(made("--force -o " + path("out")).code, 0);
    std::set<std::string> names;
    for (const auto& file : std::filesystem::directory_iterator(path("out")))
        names.insert(file.path().filename());
    EXPECT_EQ(names, (std::set<std::string>{"errors.png", "material.json", "material.ktx2"}));
}

TEST_F(Svbrdf, TrialsOfMoreClustersThanMaterialsAreOne) {
    writeMap("kd.pfm", 4, 4, [](int x, int) { return 0.2F + 0.2F * static_cast<float>(x % 3); });
    describe("lambert", {{"kd", {{"map", "kd.pfm"}}}});
    for (const int asked : {2, 32, 256}) {
        const Answer answer =
            made("--force -o " + path("out") +
                 fmt::format(" --form clusters --mips none --clusters {}", asked));
        ASSERT_EQ(answer.code, 0) << answer.err;
        std::vector<int> counts;
        const Json document = Json::parse(answer.out);
        for (const Json& choice : document["choices"])
            if (choice["form"] == "clusters") counts.push_back(choice["count"]);
        EXPECT_EQ(counts, asked == 2 ? (std::vector<int>{2, 3}) : std::vector<int>{3}) << asked;
    }
}

/// Two diffuse texels share the material b = (1/.2 + 1/.6) / (1/.2^2 + 1/.6^2) = 0.24, the mean in
/// relative squares. Over wi the mean of ln(1 + u cos) is ((1 + u) ln(1 + u) - u) / u, u = albedo /
/// pi; albedos differ by 0.36 at most and f cos by that over pi.
TEST_F(Svbrdf, ErrorsAgainstBrdfsHaveTheirClosedForm) {
    writeMap("kd.pfm", 2, 1, [](int x, int) { return x == 0 ? 0.2F : 0.6F; });
    describe("lambert", {{"kd", {{"map", "kd.pfm"}}}});
    const Answer answer = made("-o " + path("out") + " --form clusters --clusters 1 --mips none");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json answered = Json::parse(answer.out);
    const Json choices = answered["choices"];
    const auto one = std::ranges::find_if(
        choices, [](const Json& c) { return c["form"] == "clusters" && c["count"] == 1; });
    ASSERT_NE(one, choices.end());
    const Json found = (*one)["against_brdfs"];
    const auto mean = [](double albedo) {
        const double u = albedo / M_PI;
        return ((1 + u) * std::log1p(u) - u) / u;
    };
    const double low = mean(0.24) - mean(0.2), high = mean(0.6) - mean(0.24);
    EXPECT_EQ(found["texels"], 2);
    EXPECT_NEAR(found["log_error"]["mean"], (low + high) / 2, 0.01 * high);
    EXPECT_NEAR(found["log_error"]["maximum"], high, 0.01 * high);
    EXPECT_EQ(found["log_error"]["column"], 1);
    EXPECT_NEAR(found["albedo"]["error"], 0.36, 0.01);
    EXPECT_EQ(found["albedo"]["column"], 1);
    EXPECT_NEAR(found["largest_difference"]["value"], 0.36 / M_PI, 0.002);
    ASSERT_EQ(choices.front()["form"], "outgoing");
    EXPECT_LT(choices.front()["against_brdfs"]["log_error"]["maximum"], 1e-5);
}

TEST_F(Svbrdf, BrokenMapsEndBeforeAnyWork) {
    writeMap("a.pfm", 4, 4, [](int, int) { return 0.5F; });
    writeMap("small.pfm", 4, 3, [](int, int) { return 0.5F; });
    writeMap("nan.pfm", 4, 4, [](int x, int y) { return x == 2 && y == 1 ? NAN : 0.5F; });
    writeMap("high.pfm", 4, 4, [](int x, int) { return x == 3 ? 1.5F : 0.5F; });
    std::ofstream(path("cut.pfm"), std::ios::binary) << bytes("a.pfm").substr(0, 40);
    const auto refused = [&](const Json& parameters, const std::string& part) {
        describe("ggx", parameters);
        const Answer answer = made("-o " + path("out"));
        EXPECT_EQ(answer.code, 3) << answer.err;
        EXPECT_NE(answer.err.find(part), std::string::npos) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
        EXPECT_FALSE(std::filesystem::exists(path("out")));
    };
    const auto map = [](const char* file) { return Json{{"map", file}}; };
    refused({{"alpha", map("a.pfm")}, {"ks", map("small.pfm")}}, "has 4 x 3 texels");
    refused({{"alpha", map("nan.pfm")}}, "texel (2, 1): alpha is nan");
    refused({{"kd", map("high.pfm")}, {"alpha", map("nothing.pfm")}}, "nothing.pfm");
    refused({{"alpha", map("cut.pfm")}}, "cut.pfm");
    refused({{"alpha", {{"map", "a.pfm"}, {"channels", {"G"}}}}}, "has no channel G");
    refused({{"alpha", 0.5}}, "no parameter is a map");
    refused({{"alfa", map("a.pfm")}}, "did you mean 'alpha'");
    refused({{"alpha", {{"map", "a.pfm"}, {"gamma", 2}}}}, "gamma");
}

}  // namespace
