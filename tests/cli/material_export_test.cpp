// Standard materials as a user meets them: the files' contents, stated losses, refusals.

#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

std::uint32_t wordAt(const std::string& bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (int k = 3; k >= 0; --k) word = word << 8 | static_cast<unsigned char>(bytes.at(at + k));
    return word;
}

/// The JSON chunk of a .glb file, by the layout of the specification (4.4).
Json jsonOf(const std::string& bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(wordAt(bytes, 4), 2u);
    EXPECT_EQ(wordAt(bytes, 8), bytes.size());
    const std::uint32_t length = wordAt(bytes, 12);
    EXPECT_EQ(length % 4, 0u);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    EXPECT_EQ(bytes.substr(24 + length, 4), std::string("BIN\0", 4));
    EXPECT_EQ(28 + length + wordAt(bytes, 20 + length), bytes.size());
    return Json::parse(bytes.substr(20, length));
}

/// Whether bytes begin as a PNG of that size does (specification 5.2 and 11.2.2).
bool isPng(const std::string& bytes, std::uint32_t width, std::uint32_t height) {
    if (bytes.substr(0, 8) != "\x89PNG\r\n\x1a\n") return false;
    const auto big = [&](std::size_t at) { return __builtin_bswap32(wordAt(bytes, at)); };
    return big(16) == width && big(20) == height;
}

// The fit's sheen is grey; the source's is red over a blue base.
TEST_F(Cli, GltfHasTheColoursOfAFittedSheen) {
    const std::string spec = "openpbr:base_color=.2/.1/.4,fuzz_weight=.8,fuzz_color=.7/.1/.1";
    const Answer answer =
        run("export " + spec + " --target gltf --name fuzz --json -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export_materials"));
    const Json material = jsonOf(read(path("out/fuzz.glb")))["materials"][0];
    const Json sheen = material["extensions"]["KHR_materials_sheen"]["sheenColorFactor"];
    EXPECT_GT(sheen[0].get<double>(), 2 * sheen[1].get<double>()) << sheen;
    EXPECT_GT(sheen[0].get<double>(), 2 * sheen[2].get<double>()) << sheen;
    // By another measure than the loss of the search, it is nearer to the source than the fit.
    const auto distanceOf = [&](const Json& own) {
        const Answer compared =
            run("compare " + spec + " " + own["spec"].get<std::string>() + " --json");
        EXPECT_EQ(compared.code, 0) << compared.err;
        return Json::parse(compared.out)["picture"]["ciede2000"]["mean"].get<double>();
    };
    const Answer fitted = run("fit " + spec + " --model gltf-pbr --accept --json");
    ASSERT_EQ(fitted.code, 0) << fitted.err;
    EXPECT_LT(distanceOf(Json::parse(answer.out)["files"][0]),
              0.8 * distanceOf(Json::parse(fitted.out)));
}

TEST_F(Cli, GltfHasTheParametersThatAreGiven) {
    const Answer answer = run(
        "export gltf-pbr:baseColorFactor=.9/.5/.1,metallicFactor=.25,roughnessFactor=.4,ior=1.7,"
        "clearcoatFactor=.5,clearcoatRoughnessFactor=.125 --target gltf --name paint --json -o " +
        path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export_materials"));
    EXPECT_EQ(Json::parse(answer.out)["files"][0]["path"], "paint.glb");
    const Json json = jsonOf(read(path("out/paint.glb")));
    const Json& material = json["materials"][0];
    EXPECT_EQ(material["name"], "paint");
    EXPECT_EQ(material["pbrMetallicRoughness"],
              Json::parse(R"({"baseColorFactor": [0.9, 0.5, 0.1, 1.0], "metallicFactor": 0.25,
                              "roughnessFactor": 0.4})"));
    EXPECT_EQ(material["extensions"], Json::parse(R"({"KHR_materials_ior": {"ior": 1.7},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.125}})"));
    EXPECT_EQ(json["extensionsUsed"].size(), 2u);
    EXPECT_TRUE(material["extras"]["hshfit"]["loss"].contains("reason"));
}

// The thickness is the maximum of a range without a texture; the node gltf_pbr has another default
// of it, so that a film is written whole.
TEST_F(Cli, FilmsAreInBothFiles) {
    const std::string gltf =
        "gltf-pbr:baseColorFactor=.5,iridescenceFactor=.75,iridescenceIor=1.75";
    const std::string out = " --json --name film -o " + path("out");
    ASSERT_EQ(run("export " + gltf + ",iridescenceThickness=250 --target gltf" + out).code, 0);
    const Json json = jsonOf(read(path("out/film.glb")));
    const Json expected = Json::parse(R"({"KHR_materials_iridescence": {"iridescenceFactor": 0.75,
        "iridescenceIor": 1.75, "iridescenceThicknessMaximum": 250.0}})");
    EXPECT_EQ(json["materials"][0]["extensions"], expected);
    EXPECT_EQ(json["extensionsUsed"], Json::array({"KHR_materials_iridescence"}));
    ASSERT_EQ(run("export " + gltf + " --target materialx" + out).code, 0);
    const std::string node = read(path("out/film.mtlx"));
    for (const char* input : {R"(name="iridescence" type="float" value="0.75")",
                              R"(name="iridescence_ior" type="float" value="1.75")",
                              R"(name="iridescence_thickness" type="float" value="400)"})
        EXPECT_NE(node.find(input), std::string::npos) << input << node;
    ASSERT_EQ(
        run("export openpbr:thin_film_weight=.5,thin_film_ior=1.75 --target materialx --force" +
            out)
            .code,
        0);
    const std::string openpbr = read(path("out/film.mtlx"));
    for (const char* input : {R"(name="thin_film_weight" type="float" value="0.5")",
                              R"(name="thin_film_ior" type="float" value="1.75")",
                              R"(name="thin_film_thickness" type="float" value="0.5")"})
        EXPECT_NE(openpbr.find(input), std::string::npos) << input << openpbr;
    EXPECT_EQ(openpbr.find("coat"), std::string::npos);
}

// Wider along y and along 30 degrees, where OpenPBR's own axis is x. MaterialX turns clockwise.
TEST_F(Cli, BrushedMetalsAreTurnedInOpenpbr) {
    struct Case {
        const char* spec;
        double degrees;
    };
    for (const auto& [spec, expected] :
         {Case{"ggx:ax=.15,ay=.4,F0=.9/.6/.3", 90},
          Case{"grey:gltf-pbr:roughnessFactor=.4,anisotropyStrength=.6,anisotropyRotation="
               "0.52359877559829887",
               30}}) {
        const Answer answer = run(std::string("export ") + spec +
                                  " --target materialx --name b --json --force -o " + path("out"));
        ASSERT_EQ(answer.code, 0) << answer.err;
        const Json file = Json::parse(answer.out)["files"][0];
        EXPECT_LT(file["loss"]["picture"]["flip"]["mean"], 1e-3) << file;
        const std::string text = read(path("out/b.mtlx"));
        EXPECT_EQ(text.find("geometry_coat_tangent"), std::string::npos) << "there is no coat";
        EXPECT_NE(
            text.find(R"(name="geometry_tangent" type="vector3" nodename="b_geometry_tangent")"),
            std::string::npos)
            << text;
        const std::string amount = R"(name="amount" type="float" value=")";
        const std::size_t at = text.find(amount);
        ASSERT_NE(at, std::string::npos) << text;
        const double turn = -std::stod(text.substr(at + amount.size()));
        EXPECT_NEAR(std::remainder(turn - expected, 180), 0, 1e-3) << text;
    }
}

// A material of another model is fitted. The losses are over the pairs of `compare`, name a
// maximum, and stand in the answer and in the files.
TEST_F(Cli, LossIsStatedInAnswerAndFiles) {
    const Answer answer =
        run("export ggx:alpha=.3,F0=.9/.6/.3,kd=.05 --target gltf,materialx --extensions none "
            "--name g --json -o " +
            path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export_materials"));
    const Json files = Json::parse(answer.out)["files"];
    ASSERT_EQ(files.size(), 2u);
    for (const Json& file : files) {
        EXPECT_TRUE(file["fitted"]);
        EXPECT_LT(file["loss"]["mean_log"], 0.05) << file;
        EXPECT_GT(file["loss"]["mean_log"], 0) << file;
        EXPECT_GE(file["loss"]["maximum"]["value"], file["loss"]["mean_log"]);
        // Both models hold a GGX metal; the diffuse part below it is outside of them.
        EXPECT_LT(file["loss"]["picture"]["flip"]["mean"], 0.2) << file;
        EXPECT_TRUE(isPng(read(path("out/" + file["pictures"].get<std::string>())), 480, 320));
    }
    const Json json = jsonOf(read(path("out/g.glb")));
    EXPECT_EQ(json["materials"][0]["extras"]["hshfit"]["loss"], files[0]["loss"]);
    EXPECT_EQ(json["materials"][0]["extras"]["hshfit"]["spec"], files[0]["spec"]);
    EXPECT_NE(read(path("out/g.mtlx")).find("FLIP"), std::string::npos);
}

// A material of the model itself is found again without any extension.
TEST_F(Cli, FitFindsAGltfMaterialWithoutExtensions) {
    const std::string material =
        "gltf-pbr:baseColorFactor=0.7/0.4/0.2,metallicFactor=0.3,roughnessFactor=0.6";
    const Answer answer =
        run("fit '" + material + "' --model gltf-pbr --samples 3000 --starts 4 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "fit"));
    const Json fit = Json::parse(answer.out)["fit"];
    EXPECT_EQ(fit["parts"]["trials"][0]["parts"].size(), 0u);
    EXPECT_TRUE(fit["parts"]["trials"][0]["taken"]);
    EXPECT_LT(fit["rms"], 1e-6);
    for (const Json& parameter : fit["parameters"]) {
        if (parameter["name"] == "roughnessFactor") {
            EXPECT_NEAR(parameter["value"], 0.6, 1e-4);
        }
    }
}

TEST_F(Cli, DefaultFitsLookAsGoodAsThoseOfTheBestLoss) {
    const auto flipOf = [&](const std::string& loss) {
        const Answer answer =
            run("fit lambert:kd=.35/.02/.03+ggx:alpha=.1,F0=.05 --model "
                "gltf-pbr --accept --json" +
                loss);
        EXPECT_EQ(answer.code, 0) << answer.err;
        return Json::parse(answer.out)["picture"]["flip"]["mean"].get<double>();
    };
    const double own = flipOf("");
    for (const std::string loss : {"picture", "l2", "log"})
        EXPECT_LT(own, 1.1 * flipOf(" --loss " + loss)) << loss;
}

// A narrow lobe on black, of which `l2` lights all of the sphere, for a lower FLIP.
TEST_F(Cli, DefaultFitsKeepTheColoursOfTheSphere) {
    const auto colourOf = [&](const std::string& loss) {
        const Answer answer = run("fit phong:exponent=200 --model gltf-pbr --accept --json" + loss);
        EXPECT_EQ(answer.code, 0) << answer.err;
        return Json::parse(answer.out)["picture"]["ciede2000"]["mean"].get<double>();
    };
    EXPECT_LT(3 * colourOf(""), colourOf(" --loss l2"));
}

// A metal without a coat, and a diffuse surface that has no lobe for a roughness to be of.
TEST_F(Cli, DefaultFitsHaveNothingThatTheSourceDoesNotShow) {
    const auto specOf = [&](const std::string& arguments) {
        const Answer answer = run("fit " + arguments + " --json");
        EXPECT_EQ(answer.code, 0) << answer.err;
        return Json::parse(answer.out)["spec"].get<std::string>();
    };
    const std::string metal = specOf("ggx:alpha=.02,F0=.9 --model openpbr");
    EXPECT_EQ(metal.find("coat"), std::string::npos) << metal;
    const std::string_view key = "specular_roughness=";
    ASSERT_NE(metal.find(key), std::string::npos) << metal;
    EXPECT_NEAR(std::stod(metal.substr(metal.find(key) + key.size())), std::sqrt(0.02), 1e-5);
    const std::string chalk = specOf("oren-nayar:sigma=.5 --model gltf-pbr");
    EXPECT_EQ(chalk.find("oughness"), std::string::npos) << chalk;
    EXPECT_EQ(chalk.find("ior"), std::string::npos) << chalk;
}

/// The value of an input of the UsdPreviewSurface of a layer.
std::string inputOf(const std::string& layer, const std::string& name) {
    const std::string key = " inputs:" + name + " = ";
    const std::size_t first = layer.find(key);
    if (first == std::string::npos) return "none";
    return layer.substr(first + key.size(), layer.find('\n', first) - first - key.size());
}

// The material of MaterialX beside it is at the place where OpenUSD's reader puts surfacematerials.
TEST_F(Cli, UsdHasTheParametersThatAreGivenAndMaterialXByReference) {
    const std::string spec =
        "gltf-pbr:baseColorFactor=.9/.5/.1,metallicFactor=0,roughnessFactor=.4,clearcoatFactor=.5,"
        "clearcoatRoughnessFactor=.125";
    const Answer answer =
        run("export " + spec + " --target usd --name 'paint 1' --json -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export_materials"));
    const Json files = Json::parse(answer.out)["files"];
    ASSERT_EQ(files.size(), 2u);
    EXPECT_EQ(files[1]["path"], "paint 1.usda");
    EXPECT_FALSE(files[1]["fitted"]);
    const std::string layer = read(path("out/paint 1.usda"));
    EXPECT_EQ(layer.substr(0, 10), "#usda 1.0\n");
    for (const auto& [name, value] :
         std::vector<std::pair<std::string, std::string>>{{"diffuseColor", "(0.9, 0.5, 0.1)"},
                                                          {"metallic", "0"},
                                                          {"roughness", "0.4"},
                                                          {"ior", "1.5"},
                                                          {"clearcoat", "0.5"},
                                                          {"clearcoatRoughness", "0.125"}})
        EXPECT_EQ(inputOf(layer, name), value) << name;
    EXPECT_NE(layer.find("@./paint 1.mtlx@</MaterialX/Materials/paint_1>"), layer.npos);
    EXPECT_NE(read(path("out/paint 1.mtlx")).find("<surfacematerial name=\"paint_1\""),
              std::string::npos);
    EXPECT_NE(layer.find("metersPerUnit = 1\n    upAxis = \"Y\""), layer.npos);
}

// Fits keep to inputs that the surface has; the loss is stated in the layer.
TEST_F(Cli, UsdIsFittedWhereTheSurfaceHasNoInput) {
    const Answer answer =
        run("export gltf-pbr:baseColorFactor=.6/.3/.2,metallicFactor=0,sheenColorFactor=.5,"
            "sheenRoughnessFactor=.5 --target usd --extensions none --json --name c -o " +
            path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_NE(answer.err.find("no sheenColorFactor"), std::string::npos) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "export_materials"));
    const Json file = Json::parse(answer.out)["files"][1];
    EXPECT_EQ(file["target"], "usd");
    EXPECT_TRUE(file["fitted"]);
    const std::string metallic = inputOf(read(path("out/c.usda")), "metallic");
    EXPECT_TRUE(metallic == "0" || metallic == "1") << metallic;
    EXPECT_EQ(file["spec"].get<std::string>().find("sheenColorFactor"), std::string::npos);
}

TEST_F(Cli, UsdStatesTheLossOfAMetal) {
    const Answer answer =
        run("export ggx:alpha=.2,F0=.9/.6/.3 --target usd --extensions none --name m --json -o " +
            path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json file = Json::parse(answer.out)["files"][1];
    const std::string layer = read(path("out/m.usda"));
    EXPECT_EQ(inputOf(layer, "metallic"), "1");
    EXPECT_NEAR(std::stod(inputOf(layer, "roughness")), std::sqrt(.2), 1e-3);
    EXPECT_LT(file["loss"]["picture"]["flip"]["mean"], 0.01) << file;
    EXPECT_NE(layer.find("FLIP"), std::string::npos);
    EXPECT_TRUE(isPng(read(path("out/m_usd.png")), 480, 320));
}

TEST_F(Cli, MeshIsTheUsers) {
    write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    const Answer answer = run("export gltf-pbr --target gltf --name t --mesh " + path("t.obj") +
                              " -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json json = jsonOf(read(path("out/t.glb")));
    EXPECT_EQ(json["accessors"][0]["count"], 3);
    EXPECT_EQ(json["accessors"][0]["max"], Json::parse("[1.0, 2.0, 0.0]"));
}

TEST_F(Cli, MaterialsRefuseWhatTheyCannotTake) {
    write("broken.obj", "v 0 0 0\nf 1 2 3\n");
    write("broken.json", R"({"format": "hshfit-preset", "version": 1, "spec": 3})");
    const std::string out = " -o " + path("out");
    expectError("export gltf-pbr --target gltf --mesh " + path("broken.obj") + out, 3, "broken.obj",
                2);
    expectError("export gltf-pbr --target gltf --mesh " + path("absent.obj") + out, 3, "absent.obj",
                2);
    expectError("export " + path("broken.json") + " --target gltf" + out, 3, "broken.json", 2);
    expectError("export " + path("absent.json") + " --target materialx" + out, 3, "absent.json", 2);
    expectError("export gltf-pbr:roughnessFactor=2 --target gltf" + out, 2, "0 to 1", 2);
    expectError("export gltf-pbr --target gltf,bin" + out, 2, "apart from", 2);
    expectError("export gltf-pbr --target gltf --order 5" + out, 2, "--order", 2);
    expectError("export x.json --target bin --mesh y.obj" + out, 2, "--mesh", 2);
    expectError("export lambert --target gltf --extensions coat" + out, 2, "clearcoat", 2);
    expectError("fit lambert --model ggx --extensions auto", 2, "--extensions", 2);
    expectError("export lambert --target usd --name a@b" + out, 2, "without '@'", 2);
    expectError("export lambert --target usd --extensions ior" + out, 2, "auto, none or all", 2);
}

TEST_F(Cli, MaterialsAreReplacedByForceAlone) {
    const std::string command = "export gltf-pbr --target gltf --name a -o " + path("out");
    ASSERT_EQ(run(command).code, 0);
    const std::string first = read(path("out/a.glb"));
    EXPECT_EQ(run(command).code, 5);
    EXPECT_EQ(run(command + " --force").code, 0);
    EXPECT_EQ(read(path("out/a.glb")), first);
}

}  // namespace
