// `hshfit choose` as a user runs it: its rows are held to `compare`, to the files that their
// commands write, and to the bounds that are asked for.

#include "places.h"
#include "program.h"

#include <hshfit/gpu/containers/targets.h>

#include <jobs/studies/choose_renderers.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

/// Grey, so that fits are quick.
constexpr const char* matte = "'lambert:kd=.3 + ggx:alpha=.4,F0=.05'";
constexpr const char* plastic = "'lambert:kd=.35/.02/.03 + ggx:alpha=.3,F0=.05'";

class ChooseCommand : public Cli {
protected:
    Json choose(const std::string& arguments) const {
        const Answer answer = run("choose " + arguments + " --json");
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "choose"));
        return Json::parse(answer.out, nullptr, false);
    }

    /// Runs a command line of an answer in this test's folder.
    void runLine(std::string line) const {
        const std::string word = "hshfit ";
        for (std::size_t at = 0; (at = line.find(word, at)) != line.npos;
             at += test::program().size() + 1)
            line.replace(at, word.size(), test::program() + " ");
        const std::string all =
            "(cd " + folder_.string() + " && " + line + ") >" + path("said") + " 2>&1";
        EXPECT_EQ(std::system(all.c_str()), 0) << line << "\n" << read(path("said"));
        fs::remove(path("said"));
    }
};

constexpr const char* quick = " --kinds model,lobes,gltf";

/// FLIP, false dip and peak of each row are what `compare` says of the file that the row's command
/// writes, and bytes of coefficients are what `project` states.
TEST_F(ChooseCommand, StatesTheErrorsAndBytesOfWhatItsCommandsWrite) {
    const Json answer = choose(matte);
    std::set<std::string> kinds;
    for (const Json& row : answer["rows"]) {
        kinds.insert(row["kind"]);
        std::string written = row["spec"];
        if (!row["command"].is_null()) {
            std::string line = row["command"];
            if (line.find("hshfit project ") == 0) line += " --json > projected.json";
            fs::remove_all(path("out"));
            fs::create_directory(path("out"));
            runLine("cd out && " + line);
            if (line.find("hshfit export ") == std::string::npos) {
                for (const auto& file : fs::directory_iterator(path("out")))
                    if (file.path().filename() != "projected.json") written = file.path();
            }
        }
        if (fs::exists(path("out/projected.json"))) {
            const Json projected = Json::parse(read(path("out/projected.json")));
            EXPECT_EQ(projected["representation"]["bytes"], row["bytes"]) << row["name"];
        }
        const Answer compared =
            run(std::string("compare ") + matte + " '" + written + "' --metrics nbrdf --json");
        ASSERT_EQ(compared.code, 0) << compared.err;
        const Json picture = Json::parse(compared.out)["picture"];
        for (const char* key : {"flip", "ciede2000"})
            EXPECT_NEAR(picture[key]["mean"].get<double>(),
                        row["picture"][key]["mean"].get<double>(), 1e-6)
                << row["name"] << key;
        for (const char* key : {"false_dip", "false_peak", "ridge"})
            EXPECT_NEAR(picture[key]["value"].get<double>(),
                        row["picture"][key]["value"].get<double>(), 1e-6)
                << row["name"] << key;
        fs::remove_all(path("out"));
    }
    EXPECT_EQ(kinds, (std::set<std::string>{"model", "lobes", "gltf", "openpbr", "halfway",
                                            "coefficients"}));
}

/// A metal has the colour of F0, which goes to white at the horizon.
TEST_F(ChooseCommand, FitsOfLobesHoldAColouredMetal) {
    const Json answer = choose("ggx:alpha=.3,F0=.9/.6/.3 --kinds lobes");
    EXPECT_EQ(answer["rows"].size(), 4);
    for (const Json& row : answer["rows"])
        if (row["name"] == "Lambert + GGX, ks 1") {
            EXPECT_LT(row["picture"]["flip"]["mean"], 1e-6);
            return;
        }
    ADD_FAILURE() << answer.dump();
}

/// kd has three numbers, alpha and F0 one each; a model is its own best stand-in.
TEST_F(ChooseCommand, TakesAModelForItself) {
    const Json answer = choose(plastic + std::string(quick));
    const Json& row = answer["rows"][answer["recommended"].get<std::size_t>()];
    EXPECT_EQ(row["kind"], "model");
    EXPECT_EQ(row["bytes"], 4 * 5);
    EXPECT_EQ(row["picture"]["flip"]["mean"], 0);
    EXPECT_EQ(row["lost"], "nothing that is seen");
}

TEST_F(ChooseCommand, TakesWhatTheRendererReadsWithinTheBounds) {
    const Json gltf = choose(plastic + std::string(quick) + " --for gltf");
    EXPECT_EQ(gltf["rows"][gltf["recommended"].get<std::size_t>()]["kind"], "gltf");
    const Json three =
        choose(std::string(matte) + " --for three --kinds lobes,halfway --bytes 150 --error .2");
    const Json& row = three["rows"][three["recommended"].get<std::size_t>()];
    EXPECT_LE(row["bytes"], 150);
    for (const Json& each : three["rows"]) {
        const std::string kind = each["kind"];
        const bool taken = kind == "gltf" || kind == "halfway" || kind == "coefficients";
        EXPECT_EQ(each["unfit"].is_null(), taken && each["bytes"] <= 150) << each["name"];
    }
    // No faithful row of the kinds and bounds has fewer bytes above those that count alike.
    for (const Json& each : three["rows"])
        if (each["unfit"].is_null() && each["poor"].is_null()) {
            EXPECT_GE(std::max(128, each["bytes"].get<int>()),
                      std::max(128, row["bytes"].get<int>()));
        }
}

TEST_F(ChooseCommand, EveryTargetOfARendererIsOneOfExports) {
    for (const jobs::Renderer& renderer : jobs::renderers()) {
        if (renderer.target.empty()) continue;
        EXPECT_TRUE(std::ranges::any_of(gpu::targets(), [&](const auto& each) {
            return each.name == renderer.target;
        })) << renderer.name;
    }
    const Json filament = choose(std::string(matte) + quick + " --for filament");
    for (const Json& row : filament["rows"])
        EXPECT_EQ(row["unfit"].is_null(), row["kind"] == "gltf") << row["name"];
}

TEST_F(ChooseCommand, WritesThePageAndTheMaterial) {
    const Answer answer =
        run(std::string("choose ") + plastic + quick + " --for gltf -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    std::set<std::string> names;
    for (const auto& file : fs::directory_iterator(path("out")))
        names.insert(file.path().extension());
    EXPECT_EQ(names, (std::set<std::string>{".html", ".json", ".glb"}));
    EXPECT_TRUE(keepsSchema(read(path("out/choice.json")), "choose"));
    const std::string page = read(path("out/choice.html"));
    const Json document = Json::parse(read(path("out/choice.json")));
    std::size_t strips = 0;
    for (std::size_t at = 0; (at = page.find("data:image/png", at)) != page.npos; ++at) ++strips;
    EXPECT_EQ(strips, 2 * document["rows"].size());
}

TEST_F(ChooseCommand, WritesALayerOfUsdWithItsMaterialX) {
    const Answer answer = run(std::string("choose ") + matte +
                              " --kinds lobes,usd --for usd --json -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "choose"));
    std::set<std::string> names;
    for (const auto& file : fs::directory_iterator(path("out")))
        names.insert(file.path().extension());
    EXPECT_EQ(names, (std::set<std::string>{".html", ".json", ".mtlx", ".usda"}));
}

TEST_F(ChooseCommand, RecommendsNothingBeyondTheStatedError) {
    const Answer answer =
        run(std::string("choose ") + plastic + quick + " --for gltf --error 0 -o " + path("out"));
    EXPECT_EQ(answer.code, 4);
    EXPECT_NE(answer.err.find("the least FLIP is"), std::string::npos) << answer.err;
    for (const auto& file : fs::directory_iterator(path("out")))
        EXPECT_NE(file.path().extension(), ".glb");
}

/// The material that is exact comes before forms that take long.
TEST_F(ChooseCommand, BrushedMetalIsAGltfMaterial) {
    const Answer answer = run("choose ggx:ax=.15,ay=.4,F0=.9/.6/.3 --for three --seconds 5 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json document = Json::parse(answer.out);
    const Json& row = document["rows"][document["recommended"].get<std::size_t>()];
    EXPECT_EQ(row["kind"], "gltf");
    EXPECT_LT(row["picture"]["flip"]["mean"].get<double>(), 0.01);
}

TEST_F(ChooseCommand, LeavesOutWhatTheTimeIsTooShortFor) {
    expectError("choose ggx:alpha=.4 --seconds 0.01", 4, "of 0.01 are spent", 0);
}

/// Orders that have more terms cost more; what the bound excludes is not taken.
TEST_F(ChooseCommand, StatesAndBoundsTheCostOfShaders) {
    const std::string asked = std::string("choose ") + matte + " --json --kinds lobes";
    const Json answer = Json::parse(run(asked + ",halfway").out);
    if (answer["costs"]["device"].is_null()) GTEST_SKIP() << answer["costs"]["reason"];
    std::map<std::string, std::uint64_t> cycles;
    for (const Json& row : answer["rows"]) cycles[row["name"]] = row["cost"]["cycles"];
    EXPECT_EQ(cycles["Lambert + GGX"], answer["costs"]["ggx"]["cycles"]);
    EXPECT_LT(cycles["Lambert"], cycles["Lambert + GGX"]);
    EXPECT_LT(cycles["Lambert + 2 GGX"], cycles["halfway 5,4,3 in half"]);
    EXPECT_LT(cycles["halfway 5,4,3 in half"], cycles["halfway 7,6,5 in half"]);
    const std::uint64_t bound = cycles["Lambert + GGX"];
    const Answer bounded = run(asked + fmt::format(" --cost {}", bound));
    ASSERT_TRUE(keepsSchema(bounded.out, "choose"));
    for (const Json all = Json::parse(bounded.out); const Json& row : all["rows"])
        EXPECT_EQ(row["unfit"].is_null(), row["cost"]["cycles"] <= bound) << row["name"];
}

TEST_F(ChooseCommand, SaysThatTheDriverIsMissing) {
    setenv("VK_ICD_FILENAMES", "/nonexistent", 1);
    const Answer answer = run("choose lambert --kinds model --json");
    expectError("choose lambert --kinds model --cost 100", 4, "install mesa-vulkan-drivers", 0);
    unsetenv("VK_ICD_FILENAMES");
    ASSERT_TRUE(keepsSchema(answer.out, "choose"));
    const Json document = Json::parse(answer.out);
    EXPECT_TRUE(document["costs"]["device"].is_null());
    EXPECT_TRUE(document["rows"][0]["cost"].is_null());
}

TEST_F(ChooseCommand, RefusesWhatItDoesNotKnow) {
    expectError("choose lambert --for thre", 2, "did you mean 'three'", 0);
    expectError("choose lambert --kinds model,lobe", 2, "did you mean 'lobes'", 0);
    expectError("choose lambert --error 2", 2, "--error", 0);
    expectError("choose nowhere.bsdf", 3, "nowhere.bsdf", 0);
}

}  // namespace
}  // namespace hshfit::test
