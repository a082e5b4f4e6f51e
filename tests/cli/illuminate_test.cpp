// `illuminate` as a user meets it.

#include "kills.h"
#include "places.h"
#include "scenes.h"
#include "unstated.h"

#include <cli/program.h>

#include <hshfit/pictures/rgb_picture.h>

#include <nlohmann/json.hpp>

#include <fstream>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

class Illuminate : public Cli {
protected:
    /// The inside of a cube of six squares of albedo 0.5 that all emit 1, seen from its middle.
    static Json furnace() {
        Json objects = Json::array();
        hshfit::test::addFurnace(objects);
        return {{"format", "hshfit-scene"},
                {"version", 1},
                {"materials", {{{"name", "grey"}, {"brdf", "lambert:kd=.5"}}}},
                {"objects", objects},
                {"cameras",
                 {{{"name", "eye"},
                   {"position", {0.1, 0.2, 0.3}},
                   {"target", {1, 0, 0}},
                   {"field_of_view", 90},
                   {"width", 12},
                   {"height", 8}}}}};
    }
    static void expectErrorOf(const Answer& answer, int code, const std::string& part) {
        EXPECT_EQ(answer.code, code) << answer.err;
        EXPECT_NE(answer.err.find(part), std::string::npos) << answer.err;
    }
    Answer taken(const Json& scene, const std::string& more) const {
        std::ofstream(path("scene.json")) << scene;
        return run("illuminate " + path("scene.json") + " " + more);
    }
};

/// E / (1 - rho) = 2 in every pixel, with the stated error.
TEST_F(Illuminate, FindsTheRadianceOfAClosedRoom) {
    EXPECT_TRUE(keepsSchema(furnace().dump(), "scene"));
    const Answer answer = taken(furnace(), "-o " + path("out") + " --samples 400 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "illuminate"));
    const Json camera = Json::parse(answer.out)["cameras"][0];
    EXPECT_EQ(camera["cut"], 0);
    const double error = camera["standard_error"];
    EXPECT_NEAR(camera["mean"], 2, 2 * error);
    const hshfit::RgbPicture picture = hshfit::readRgbExr(path("out/eye.exr"));
    ASSERT_EQ(picture.width, 12);
    ASSERT_EQ(picture.height, 8);
    for (const float value : picture.values) EXPECT_NEAR(value, 2, 10 * error);
    const Answer single = taken(furnace(), "-o " + path("single") + " --samples 1 --json");
    EXPECT_TRUE(keepsSchema(single.out, "illuminate"));
    EXPECT_TRUE(Json::parse(single.out)["cameras"][0]["standard_error"].is_null());
    // Against a picture of another seed, the squared errors of both pictures add up.
    const Answer again =
        taken(furnace(), "-o " + path("again") + " --samples 400 --seed 2 --json --reference " +
                             path("out/eye.exr"));
    const double mse = Json::parse(again.out)["cameras"][0]["relative_mse"];
    EXPECT_GT(mse, 0);
    EXPECT_NEAR(mse, 2 * error * error, error * error);
}

TEST_F(Illuminate, TakesAsManyPathsAsFitIntoTheTime) {
    ASSERT_EQ(taken(furnace(), "-o " + path("free") + " --samples 8").code, 0);
    const Answer enough = taken(furnace(), "-o " + path("enough") + " --samples 8 --seconds 1000");
    ASSERT_EQ(enough.code, 0) << enough.err;
    EXPECT_EQ(hshfit::test::unstated(read(path("free/eye.exr"))),
              hshfit::test::unstated(read(path("enough/eye.exr"))));
    const Answer few =
        taken(furnace(), "-o " + path("few") + " --samples 1000000 --seconds 1 --json");
    ASSERT_EQ(few.code, 0) << few.err;
    EXPECT_TRUE(keepsSchema(few.out, "illuminate"));
    EXPECT_NE(few.err.find("of 1000000 paths a pixel fit into the time"), std::string::npos)
        << few.err;
    const Json camera = Json::parse(few.out)["cameras"][0];
    EXPECT_GE(camera["samples"], 2);
    EXPECT_LT(camera["samples"], 1000000);
    EXPECT_LT(camera["seconds"], 60);
    EXPECT_NEAR(camera["mean"], 2, 2 * camera["standard_error"].get<double>());
}

TEST_F(Illuminate, TakesTheSamePictureOnAnyNumberOfThreads) {
    for (const char* threads : {"1", "3"}) {
        ASSERT_EQ(taken(furnace(),
                        std::string("-o ") + path(threads) + " --samples 4 --threads " + threads)
                      .code,
                  0);
    }
    EXPECT_EQ(read(path("1/eye.exr")), read(path("3/eye.exr")));
    EXPECT_EQ(read(path("1/eye.png")), read(path("3/eye.png")));
}

/// A process that is killed up to 20 times, each after one more row and a random moment.
TEST_F(Illuminate, ResumedAfterKillsTakesTheSamePicture) {
    Json scene = furnace();
    scene["cameras"][0]["height"] = 96;
    const std::string samples = " --samples 512";
    ASSERT_EQ(taken(scene, "-o " + path("whole") + samples).code, 0);
    const std::string out = path("out");
    const auto kept = [&] { return hshfit::test::keptBlocks(out); };
    const int kills = hshfit::test::killedRuns(
        {"illuminate", path("scene.json"), "-o", out, "--samples", "512", "--resume", "--quiet"},
        kept, 20, 48);
    EXPECT_GT(kills, 0);
    const std::size_t rows = kept();
    EXPECT_GE(rows, static_cast<std::size_t>(kills));
    EXPECT_FALSE(std::filesystem::exists(out + "/eye.exr"));
    // Rows of another seed or another scene are not mixed in.
    expectErrorOf(taken(scene, "-o " + out + samples + " --resume --seed 2"), 3, "other inputs");
    scene["objects"][0]["emission"] = 1.5;
    expectErrorOf(taken(scene, "-o " + out + samples + " --resume"), 3, "other inputs");
    scene["objects"][0]["emission"] = 1;
    const Answer answer = taken(scene, "-o " + out + samples + " --resume --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(Json::parse(answer.out)["cameras"][0]["resumed_rows"], rows);
    for (const char* name : {"/eye.exr", "/eye.png"})
        EXPECT_EQ(hshfit::test::unstated(read(out + name)),
                  hshfit::test::unstated(read(path("whole") + name)))
            << name;
    EXPECT_FALSE(hshfit::test::hasHidden(out));
}

TEST_F(Illuminate, RefusesScenesThatCannotBeLit) {
    const auto refuses = [&](const char* pointer, const Json& value, int code,
                             const std::string& message, const std::string& more = "") {
        Json scene = furnace();
        scene[Json::json_pointer(pointer)] = value;
        const Answer answer = taken(scene, "-o " + path("none") + " --samples 1 " + more);
        EXPECT_EQ(answer.code, code) << message;
        EXPECT_NE(answer.err.find(message), std::string::npos) << answer.err;
        EXPECT_FALSE(std::filesystem::exists(path("none"))) << message;
    };
    refuses("/objects/0/material", "gold", 3, "'objects[0].material' is 'gold'; valid: grey");
    refuses("/objects/1/mesh", "no.obj", 3, "no.obj");
    refuses("/objects/2/emission", -1, 3, "'objects[2].emission'");
    refuses("/objects/2/scale", {1, 0, 1}, 3, "'objects[2].scale' holds 0");
    refuses("/materials/0/brdf", "lambertt", 3, "lambertt");
    refuses("/cameras/0/target", {0.1, 0.2, 0.3}, 2, "stands on its target");
    refuses("/cameras/0/colour", 1, 3, "'cameras[0].colour' is not known; valid: name");
    refuses("/version", 1, 2, "it has no camera 'ear'; it has: eye", "--camera ear");
    Json dark = furnace();
    for (Json& object : dark["objects"]) object.erase("emission");
    const Answer answer = taken(dark, "-o " + path("none"));
    EXPECT_EQ(answer.code, 3);
    EXPECT_NE(answer.err.find("is dark: give 'lights'"), std::string::npos) << answer.err;
}

/// Few rays, so that tests are short.
const std::string quick =
    " --method radiance-cache --rays 64 --surface-points 100 --surface-rays 16 --samples 2 ";

TEST_F(Illuminate, HidesAClosedRoomByARadianceCache) {
    const Answer answer =
        taken(furnace(), "-o " + path("out") + quick + "--direct gathered --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "illuminate"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["method"], "radiance-cache");
    EXPECT_EQ(json["materials"][0]["way"], "irradiance");
    const Json camera = json["cameras"][0];
    EXPECT_GT(camera["records"], 3);
    EXPECT_EQ(camera["new_records"], camera["records"]);
    EXPECT_GT(camera["bytes"], 0);
    for (const float value : hshfit::readRgbExr(path("out/eye.exr")).values)
        EXPECT_NEAR(value, 2, 2e-3);
    EXPECT_TRUE(std::filesystem::exists(path("out/eye.records.png")));
}

/// Two runs that hand on records take the pictures of one run, and a third adds none.
TEST_F(Illuminate, KeepsRecordsInAFile) {
    Json scene = furnace();
    scene["objects"][0]["emission"] = 3;
    Json other = scene["cameras"][0];
    other["name"] = "other";
    other["target"] = {0, 1, 0.2};
    scene["cameras"].push_back(other);
    ASSERT_EQ(taken(scene, "-o " + path("both") + quick).code, 0);
    const std::string records = " --json --records " + path("records") + quick;
    ASSERT_EQ(taken(scene, "-o " + path("first") + " --camera eye" + records).code, 0);
    const Answer second = taken(scene, "-o " + path("second") + " --camera other" + records);
    ASSERT_EQ(second.code, 0) << second.err;
    EXPECT_EQ(hshfit::test::unstated(read(path("both/other.exr"))),
              hshfit::test::unstated(read(path("second/other.exr"))));
    const Answer again = taken(scene, "-o " + path("third") + " --camera other" + records);
    ASSERT_EQ(again.code, 0) << again.err;
    const Json before = Json::parse(second.out)["cameras"][0];
    const Json after = Json::parse(again.out)["cameras"][0];
    EXPECT_GT(before["new_records"], 0);
    EXPECT_EQ(after["records"], before["records"]);
    EXPECT_EQ(after["new_records"], 0);

    const std::string whole = read(path("records"));
    const auto refuses = [&](const Json& of, const std::string& message,
                             const std::string& more = "") {
        const Answer answer = taken(of, "-o " + path("none") + records + more);
        EXPECT_EQ(answer.code, 3) << message;
        EXPECT_NE(answer.err.find(message), std::string::npos) << answer.err;
        EXPECT_FALSE(std::filesystem::exists(path("none"))) << message;
    };
    refuses(scene, "of another scene, or of other settings", " --order 9");
    scene["objects"][0]["emission"] = 4;
    refuses(scene, "of another scene, or of other settings");
    scene["objects"][0]["emission"] = 3;
    for (const std::size_t size : {whole.size() - 1, whole.size() / 2, std::size_t{40}}) {
        std::ofstream(path("records"), std::ios::binary) << whole.substr(0, size);
        refuses(scene, path("records"));
    }
}

TEST_F(Illuminate, RefusesWhatTheMethodDoesNotTake) {
    const auto refuses = [&](const std::string& more, const std::string& message) {
        const Answer answer = taken(furnace(), "-o " + path("none") + more);
        EXPECT_EQ(answer.code, 2) << message;
        EXPECT_NE(answer.err.find(message), std::string::npos) << answer.err;
        EXPECT_FALSE(std::filesystem::exists(path("none"))) << message;
    };
    refuses(quick + "--seconds 5", "--seconds is for --method path");
    refuses(" --seconds 5 --resume", "--resume");
    refuses(" --rays 100", "--rays is for --method radiance-cache");
    refuses(" --records some", "--records is for --method radiance-cache");
    refuses(quick + "--resume", "--resume is for --method path");
    refuses(quick + "--from-bounce 3", "--from-bounce is 3");
    refuses(quick + "--without gradient-limit", "leave that out too");
    refuses(quick + "--accuracy 2", "--accuracy is 2; valid: above 0, up to 1");
    refuses(quick + "--basis lsosh", "--basis 'lsosh' is not orthonormal");
    refuses(quick + "--direct gathered --from-bounce 2", "cannot leave it out");
}

}  // namespace
