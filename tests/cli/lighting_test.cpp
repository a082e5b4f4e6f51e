#include "places.h"
#include "program.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <string>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

class Lighting : public Cli {
protected:
    void project(const std::string& spec, const std::string& file, const std::string& options) {
        ASSERT_EQ(run("project " + spec + " -o " + path(file) + " " + options).code, 0);
    }
    /// Exports NAME.json with all models of lighting, under uniform light of radiance 2. The
    /// answer, and the sidecar as `written`.
    Json exported(const std::string& name, const std::string& options, Json& written) {
        const Answer answer = run("export " + path(name + ".json") + " -o " + path("out") +
                                  " --lighting all --target glsl,hlsl,slang,wgsl,glsl-es --light "
                                  "uniform:radiance=2 --json " +
                                  options);
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "lighting"));
        const std::string sidecar = read(path("out/" + name + ".lighting.json"));
        EXPECT_TRUE(keepsSchema(sidecar, "lighting"));
        written = Json::parse(sidecar);
        return Json::parse(answer.out);
    }
    /// The number at a place of a file.
    std::uint32_t word(const std::string& bytes, std::size_t offset) const {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes.data() + offset, sizeof value);
        return value;
    }
};

TEST_F(Lighting, TablesLightAndShadersOfAFormAreWrittenWithTheirErrors) {
    project("lambert:kd=.5", "grey.json", "--order 2 --outgoing 8");
    Json written;
    const Json document = exported("grey", "", written);
    for (const Json& file : document["files"])
        EXPECT_TRUE(fs::exists(path("out/" + file.get<std::string>()))) << file;
    // Under uniform light of radiance 2, albedo 0.5 reflects 1 everywhere.
    ASSERT_EQ(written["tests"].size(), 64u);
    for (const Json& test : written["tests"])
        for (const char* model : {"coefficients", "split-sum", "ltc", "prefiltered"})
            EXPECT_NEAR(test[model][1].get<double>(), 1, 2e-3) << model;
    std::size_t uniform = 0;
    for (const Json& error : document["errors"]) {
        if (error["light"] != "uniform:radiance=2") continue;
        ++uniform;
        EXPECT_LT(error["relative_l2"].get<double>(), 5e-3) << error;
    }
    EXPECT_EQ(uniform, 4u);
    for (const Json& model : document["models"]) EXPECT_EQ(model["shaders"].size(), 5u);
    // KTX 2.0: vkFormat, faceCount, levelCount; the level index names the largest level first,
    // which lies last.
    const std::string cube = read(path("out/grey.split-sum.cube.ktx2"));
    EXPECT_EQ(word(cube, 12), 97u);
    EXPECT_EQ(word(cube, 36), 6u);
    const std::size_t levels = word(cube, 40);
    for (std::size_t k = 0; k < levels; ++k) {
        const std::size_t face = word(cube, 20) >> k;
        EXPECT_EQ(word(cube, 80 + 24 * k + 8), face * face * 6 * 8);
        EXPECT_EQ(word(cube, 80 + 24 * k) % 8, 0u);
    }
    EXPECT_EQ(word(cube, 80) + word(cube, 88), cube.size());
}

/// Each model as a module, of which a file says how it is bound; its light is at binding 4.
TEST_F(Lighting, ModulesOfSpirvStateTheirBindings) {
    project("lambert:kd=.5", "grey.json", "--order 2 --outgoing 8");
    const Answer answer = run("export " + path("grey.json") + " -o " + path("out") +
                              " --lighting all --no-error --target spirv --json");
    if (answer.err.find("needs glslang") != std::string::npos) GTEST_SKIP() << answer.err;
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "lighting"));
    const std::map<std::string, std::set<int>> bound{{"coefficients", {0, 2, 3, 4}},
                                                     {"split-sum", {0, 1, 2, 3, 4}},
                                                     {"ltc", {0, 2, 3, 4}},
                                                     {"prefiltered", {0, 1, 2, 3}}};
    const Json document = Json::parse(answer.out);
    ASSERT_EQ(document["models"].size(), bound.size());
    for (const Json& model : document["models"]) {
        ASSERT_EQ(model["shaders"].size(), 1u);
        const Json shader = model["shaders"][0];
        const std::string text = read(path("out/" + shader["bindings"].get<std::string>()));
        EXPECT_TRUE(keepsSchema(text, "spirv"));
        const Json stated = Json::parse(text);
        EXPECT_EQ(stated["module"]["path"], shader["path"]);
        std::set<int> bindings;
        for (const Json& binding : stated["bindings"])
            bindings.insert(binding["binding"].get<int>());
        EXPECT_EQ(bindings, bound.at(model["model"])) << model["model"];
    }
}

TEST_F(Lighting, ErrorsAreMeasuredUnderTheLightsThatTheTimeIsEnoughFor) {
    project("lambert:kd=.5", "timed.json", "--order 2 --outgoing 8");
    const std::string base = "export " + path("timed.json") + " --target glsl-es -o " + path("out");
    const Answer answer = run(base + " --lighting split-sum,ltc --seconds 0.01 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "lighting"));
    const std::size_t errors = Json::parse(answer.out)["errors"].size();
    EXPECT_GE(errors, 2u);
    const std::string said = fmt::format("the time was over after {} of ", errors / 2);
    EXPECT_NE(answer.err.find(said), std::string::npos) << answer.err;
    EXPECT_EQ(run(base + " --seconds 1").code, 2);
    EXPECT_EQ(run(base + " --lighting ltc --seconds -1").code, 2);
}

TEST_F(Lighting, BrushedMaterialsHaveTablesByAzimuth) {
    project("ward:ax=.5,ay=.9", "ward.json", "--order 4 --outgoing 8x8");
    Json written;
    exported("ward", "--no-error", written);
    EXPECT_EQ(written["rows"]["azimuths"], 9);
    // Mirror-symmetric: harmonics of m < 0, and matrices outside the plane of incidence.
    const std::size_t widths[] = {25, 3, 4, 5};
    for (std::size_t k = 0; k < 4; ++k) {
        const Json model = written["models"][k];
        EXPECT_EQ(model["table"]["width"], widths[k]);
        EXPECT_EQ(model["table"]["height"], 9 * 32);
        EXPECT_EQ(model["bytes"], widths[k] * 9 * 32 * 16);
        EXPECT_EQ(read(path("out/" + model["table"]["files"][1]["path"].get<std::string>())).size(),
                  widths[k] * 9 * 32 * 16);
        for (const Json& shader : model["shaders"]) {
            EXPECT_NE(read(path("out/" + shader["path"].get<std::string>())).find("tangent"),
                      std::string::npos);
        }
    }
    EXPECT_GT(written["models"][1]["taps"], 1);
    // Under uniform light, every model reflects twice the albedo, and so they agree.
    for (const Json& test : written["tests"]) {
        const auto at = [&](const char* vector, std::size_t c) {
            return test[vector][c].get<double>();
        };
        EXPECT_NEAR(at("tangent", 0) * at("normal", 0) + at("tangent", 1) * at("normal", 1), 0,
                    1e-12);
        EXPECT_GT(at("coefficients", 1), 0.1);
        EXPECT_NEAR(at("split-sum", 1), at("coefficients", 1), 5e-3 * at("coefficients", 1));
        EXPECT_NEAR(at("ltc", 1), at("coefficients", 1), 5e-3 * at("coefficients", 1));
        EXPECT_NEAR(at("prefiltered", 1), at("coefficients", 1), 5e-3 * at("coefficients", 1));
    }
}

TEST_F(Lighting, TradeAndPlanChooseAmongTheModels) {
    const Answer answer =
        run("tradeoff lambert:kd=.5 --lighting all --light uniform:radiance=1 "
            "--light panel:width=60,height=60,elevation=50 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "tradeoff_lighting"));
    std::size_t front = 0;
    const Json document = Json::parse(answer.out);
    for (const Json& trade : document["brdfs"][0]["trades"]) {
        front += trade["front"].get<bool>() ? 1 : 0;
        // Quadrilaterals are exact for a diffuse surface and both lights, up to direct integration.
        if (trade["model"] == "ltc") {
            EXPECT_LT(trade["relative_l2"].get<double>(), 6e-3) << trade;
        }
    }
    EXPECT_GT(front, 1u);

    write("scene.json", R"({"format":"hshfit-scene","version":1,
        "materials":[{"name":"wall","brdf":"lambert:kd=.5"}],
        "lights":[{"kind":"sky","model":"uniform","radiance":1}],
        "budget":{"metric":"relative_l2","error":0.02}})");
    const Answer planned =
        run("plan " + path("scene.json") + " -o " + path("plan") + " --lighting all --json");
    ASSERT_EQ(planned.code, 0) << planned.err;
    EXPECT_TRUE(keepsSchema(planned.out, "plan"));
    const Json lighting = Json::parse(planned.out)["lighting"];
    ASSERT_EQ(lighting.size(), 1u);
    const Json choice = lighting[0]["choice"];
    EXPECT_LE(choice["relative_l2"].get<double>(), 0.02);
}

/// A sun in lux: prefiltered by a lobe of alpha 0.3 it is brighter than 65504. The cube is then
/// float32 and says it; one that is dim stays float16, or is float32 where that is asked for.
TEST_F(Lighting, CubesOfSunsInLuxAreFloat32) {
    project("ggx:alpha=.3", "ggx3.json", "--order 5 --outgoing 8");
    const std::string base = "export " + path("ggx3.json") + " --lighting split-sum --no-error " +
                             "--target glsl-es --light sun:elevation=40,irradiance=";
    const auto cubeOf = [&](const std::string& folder) {
        return Json::parse(read(path(folder + "/ggx3.lighting.json")))["models"][0]["cube"];
    };
    const Answer bright = run(base + "100000 -o " + path("bright"));
    ASSERT_EQ(bright.code, 0) << bright.err;
    EXPECT_NE(bright.err.find("float32"), std::string::npos);
    const Json cube = cubeOf("bright");
    EXPECT_EQ(cube["number"], "float32");
    const std::string ktx = read(path("bright/ggx3.split-sum.cube.ktx2"));
    EXPECT_EQ(word(ktx, 12), 109u);  // VK_FORMAT_R32G32B32A32_SFLOAT
    const std::string bin = read(path("bright/ggx3.split-sum.cube.f32.bin"));
    const std::size_t face = cube["levels"][0]["face"];
    EXPECT_EQ(cube["levels"][0]["bytes"], face * face * 6 * 16);
    float most = 0;
    for (std::size_t k = 0; k + 4 <= bin.size(); k += 4) {
        float value = 0;
        std::memcpy(&value, bin.data() + k, 4);
        most = std::max(most, value);
    }
    EXPECT_GT(most, 65504);

    const Answer dim = run(base + "10 -o " + path("dim"));
    ASSERT_EQ(dim.code, 0) << dim.err;
    EXPECT_EQ(cubeOf("dim")["number"], "float16");
    const Answer asked = run(base + "10 --number float32 -o " + path("asked"));
    ASSERT_EQ(asked.code, 0) << asked.err;
    EXPECT_EQ(cubeOf("asked")["number"], "float32");
    expectError(base + "100000 --number float16 -o " + path("half"), 4, "float32", 4);
    expectError(base + "10 --number unorm16 -o " + path("whole"), 2, "float16 or float32", 4);
    EXPECT_FALSE(fs::exists(path("half")) || fs::exists(path("whole")));
}

/// A BRDF itself, looked up in the environment of an engine.
TEST_F(Lighting, PrefilteredEnvironmentsTakeAnyBrdf) {
    const std::string out = " -o " + path("out");
    const Answer answer =
        run("export ggx:alpha=.4,F0=.9/.6/.3+lambert:kd=.1" + out +
            " --lighting prefiltered --engine filament --lobes 5 --target glsl,wgsl --light "
            "sky:type=12,elevation=40 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.err, "");
    EXPECT_TRUE(keepsSchema(answer.out, "lighting"));
    const Json model = Json::parse(answer.out)["models"][0];
    EXPECT_EQ(model["engine"], "filament");
    EXPECT_EQ(model["lobes"], 5);
    EXPECT_EQ(model["bytes"], 32 * 8 * 16);
    EXPECT_EQ(model["light_bytes"], 0);
    const std::string shader = read(path("out/ggx_hsh_prefiltered.glsl"));
    EXPECT_NE(shader.find("#ifndef HSH_PREFILTERED_LIGHT"), std::string::npos);
    EXPECT_NE(shader.find("return 4.0 * r * (2.0 - r);"), std::string::npos);
    // Five lobes see a glossy metal under every light of the catalog but single suns.
    for (const Json all = Json::parse(answer.out); const Json& error : all["errors"]) {
        const std::string light = error["light"];
        if (light.rfind("sky", 0) == 0 || light.rfind("preetham", 0) == 0) {
            EXPECT_LT(error["relative_l2"].get<double>(), 0.05) << error;
        }
    }
}

TEST_F(Lighting, BadInputIsRefused) {
    project("lambert", "plain.json", "--order 2 --outgoing 4");
    const std::string out = " -o " + path("out");
    expectError("export " + path("plain.json") + out + " --lighting fog", 2, "split-sum", 1);
    expectError("export " + path("plain.json") + out + " --lighting coefficients " +
                    "--environment-order 40",
                2, "40 bands", 1);
    expectError("export lambert" + out + " --lighting prefiltered --engine unrael", 2,
                "did you mean 'unreal'", 1);
    expectError("export lambert" + out + " --lighting prefiltered --lobes 7", 2, "1 to 6", 1);
    expectError("export " + path("plain.json") + out + " --lobes 2", 2, "is for --lighting", 1);
    expectError("export lambert" + out + " --lighting ltc --engine unity", 2,
                "--lighting prefiltered", 1);
    EXPECT_FALSE(fs::exists(path("out")));
}

}  // namespace
}  // namespace hshfit::test
