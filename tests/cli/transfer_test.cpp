// `transfer` as a user meets it.

#include "kills.h"
#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <sstream>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

class Transfer : public Cli {
protected:
    /// A wall on a floor.
    static Json corner() {
        return {{"format", "hshfit-scene"},
                {"version", 1},
                {"materials",
                 {{{"name", "grey"}, {"brdf", "lambert:kd=.5"}},
                  {{"name", "red"}, {"brdf", "lambert:kd=.8/.2/.1"}},
                  {{"name", "satin"}, {"brdf", "ggx:alpha=.5,F0=.8"}}}},
                {"objects",
                 {{{"mesh", "square"}, {"material", "grey"}, {"name", "floor"}},
                  {{"mesh", "square"},
                   {"material", "red"},
                   {"name", "wall"},
                   {"theta", 90},
                   {"at", {-1, 0, 1}}},
                  {{"mesh", "square"},
                   {"material", "satin"},
                   {"name", "plate"},
                   {"scale", 0.4},
                   {"at", {0, 0, 0.5}}}}},
                {"lights", {{{"light", "sky:type=12,elevation=40"}}}},
                {"cameras",
                 {{{"name", "eye"},
                   {"position", {3, -3, 2}},
                   {"target", {0, 0, 0.4}},
                   {"width", 24}}}}};
    }
    Answer transferred(const Json& scene, const std::string& more) const {
        std::ofstream(path("scene.json")) << scene;
        return run("transfer " + path("scene.json") + " -o " + path("out") + " " + more);
    }
    /// The arrays as another program reads them.
    Json readBack(const std::string& what) const {
        const std::string command = "/usr/bin/python3 " + hshfit::test::sourceFolder() +
                                    "/tests/cli/read_transfer.py " + path("out") + " " + what +
                                    " > " + path("read.json");
        EXPECT_EQ(std::system(command.c_str()), 0);
        return Json::parse(read(path("read.json")), nullptr, false);
    }
};

TEST_F(Transfer, SaysWhatItWroteAndOthersReadIt) {
    EXPECT_TRUE(keepsSchema(corner().dump(), "scene"));
    const Answer answer = transferred(
        corner(), "--rays 100 --order 3 --passes 3 --edge .5 --reference-samples 16 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "transfer"));
    EXPECT_TRUE(keepsSchema(read(path("out/transfer.json")), "transfer"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["rays"]["traced"], 100 * json["vertices"].get<int>());
    ASSERT_EQ(json["energy"].size(), 4);
    double energy = 0;
    for (const double pass : json["energy"]) energy += pass;
    const Json found = readBack("tensor");
    EXPECT_EQ(found["vertices"], json["vertices"]);
    EXPECT_NEAR(found["energy"], energy, 1e-5 * energy);
    EXPECT_EQ(found["channels"], 3);
    // The clamped cosine's first bands.
    EXPECT_LE(found["unshadowed_error"], 1e-6);
    const Json glb = readBack("glb");
    EXPECT_EQ(glb["vertices"], json["vertices"]);
    EXPECT_EQ(glb["triangles"], json["triangles"]);
    EXPECT_NEAR(glb["energy"], energy, 1e-5 * energy);
    for (const Json& file : json["files"]) EXPECT_TRUE(std::filesystem::exists(file)) << file;
    // Vectors see GGX as diffuse with its albedo, which is neither black nor white.
    EXPECT_FALSE(json["materials"][2]["diffuse"]);
    EXPECT_GT(json["materials"][2]["albedo"][0], 0.4);
    EXPECT_LT(json["materials"][2]["albedo"][0], 0.9);
    const double first = json["pictures"][0]["errors"][0]["relative_l2"],
                 last = json["pictures"][0]["errors"][2]["relative_l2"];
    EXPECT_LT(last, 0.5 * first);
}

TEST_F(Transfer, TakesOnlyTheRaysThatFitIntoTheTime) {
    const std::string options = "--order 3 --passes 2 --edge .5 --json ";
    const Answer free = transferred(corner(), options + "--rays 100");
    const Answer enough = transferred(corner(), options + "--rays 100 --seconds 1000 --force");
    ASSERT_EQ(enough.code, 0) << enough.err;
    EXPECT_EQ(Json::parse(free.out)["noise"], Json::parse(enough.out)["noise"]);
    const Answer few = transferred(
        corner(), options + "--rays 1000000 --reference-samples 65536 --seconds 2 --force");
    ASSERT_EQ(few.code, 0) << few.err;
    EXPECT_TRUE(keepsSchema(few.out, "transfer"));
    EXPECT_NE(few.err.find("of 1000000 rays a vertex fit into the time"), std::string::npos)
        << few.err;
    EXPECT_NE(few.err.find("of 65536 paths a pixel fit into the time"), std::string::npos)
        << few.err;
    const Json json = Json::parse(few.out);
    const double vertices = json["vertices"], rays = json["rays"]["traced"];
    EXPECT_GE(rays, 64 * vertices);
    EXPECT_LT(rays, 1e6 * vertices);
}

TEST_F(Transfer, CompressesMatricesWithinTheAskedError) {
    const Answer answer =
        transferred(corner(),
                    "--rays 64 --order 3 --local-order 3 --passes 1 --edge .5 --clusters 1,4 "
                    "--components 24 --error .3 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "transfer"));
    const Json json = Json::parse(answer.out);
    EXPECT_LE(json["compressed"]["relative_l2"], 0.3);
    for (const Json& other : json["compression"])
        EXPECT_TRUE(other["relative_l2"] > 0.3 || other["bytes"] >= json["compressed"]["bytes"]);
    const Json found = readBack("clusters");
    EXPECT_NEAR(found["relative_l2"], json["compressed"]["relative_l2"], 1e-4);
}

TEST_F(Transfer, SaysThatMatricesMissTheAskedError) {
    const Answer answer =
        transferred(corner(),
                    "--rays 64 --order 3 --local-order 3 --passes 1 --edge .5 --clusters 1 "
                    "--components 1 --error 1e-6 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "transfer"));
    EXPECT_NE(answer.err.find("poor: the compressed matrices"), std::string::npos) << answer.err;
    EXPECT_NE(answer.err.find("more --clusters and --components"), std::string::npos) << answer.err;
    EXPECT_TRUE(Json::parse(answer.out).contains("poor"));
}

TEST_F(Transfer, LeavesNothingBehindWithResume) {
    const std::string options = "--rays 16 --order 2 --edge 1 --passes 1 ";
    ASSERT_EQ(transferred(corner(), options).code, 0);
    const std::string once = read(path("out/transfer.tensor"));
    const Answer again = transferred(corner(), options);
    EXPECT_EQ(again.code, 0);
    EXPECT_NE(again.out.find("kept "), std::string::npos) << again.out;
    const Answer other = transferred(corner(), options + "--seed 9 ");
    EXPECT_EQ(other.code, 5);
    EXPECT_NE(other.err.find("--force"), std::string::npos) << other.err;
    ASSERT_EQ(transferred(corner(), options + "--force --resume").code, 0);
    EXPECT_EQ(read(path("out/transfer.tensor")), once);
    EXPECT_FALSE(std::filesystem::exists(path("out/.hshfit-transfer.partial")));
}

/// A process that is killed while it traces rays, compresses matrices and takes pictures.
TEST_F(Transfer, ResumedAfterKillsWritesTheSameFiles) {
    const std::string options =
        "--rays 400 --order 3 --local-order 3 --passes 2 --edge .1 --clusters 8,16 --components 8 "
        "--reference-samples 64 ";
    const Answer unstopped = transferred(corner(), options);
    ASSERT_EQ(unstopped.code, 0) << unstopped.err;
    EXPECT_NE(unstopped.out.find("out/eye_scene_transfer.png\n"), std::string::npos)
        << unstopped.out;
    const std::string whole = path("whole"), out = path("out");
    std::filesystem::rename(out, whole);
    std::vector<std::string> words{"transfer", path("scene.json"), "-o",
                                   out,        "--resume",         "--quiet"};
    std::istringstream stream(options);
    for (std::string word; stream >> word;) words.push_back(word);
    const auto kept = [&] { return hshfit::test::keptBlocks(out); };
    EXPECT_GT(hshfit::test::killedRuns(words, kept, 12, 1000), 0);
    EXPECT_FALSE(std::filesystem::exists(out + "/transfer.json"));
    const Answer answer = transferred(corner(), options + "--resume --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    for (const char* name :
         {"/transfer.tensor", "/clusters.tensor", "/eye_scene_path.png", "/eye_scene_transfer.png"})
        EXPECT_EQ(read(out + name), read(whole + name)) << name;
    EXPECT_FALSE(hshfit::test::hasHidden(out));
}

TEST_F(Transfer, RefusesWhatItCannotDo) {
    std::ofstream(path("scene.json")) << corner();
    const std::string command = "transfer " + path("scene.json") + " -o " + path("out") + " ";
    expectError(command + "--memory 1", 2, "MB of memory, and --memory allows 1 MB", 1);
    expectError(command + "--edge -1", 2, "--edge", 1);
    expectError(command + "--edge 1e-5", 2, "--edge", 1);
    Json bad = corner();
    bad.erase("lights");
    bad["objects"][0]["emission"] = 1;
    std::ofstream(path("scene.json")) << bad;
    expectError(command + "--reference-samples 1", 2, "name some with --light", 1);
    bad = corner();
    bad["materials"][2]["brdf"] = "nothing";
    std::ofstream(path("scene.json")) << bad;
    expectError(command, 3, "material 'satin'", 1);
}

}  // namespace
