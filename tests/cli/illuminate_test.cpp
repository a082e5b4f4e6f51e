// `illuminate` as a user meets it.

#include "places.h"

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
        const auto add = [&](double theta, double phi, const Json& at) {
            objects.push_back({{"mesh", "square"},
                               {"material", "grey"},
                               {"emission", 1},
                               {"theta", theta},
                               {"phi", phi},
                               {"at", at}});
        };
        add(0, 0, {0, 0, -1});
        add(180, 0, {0, 0, 1});
        add(90, 0, {-1, 0, 0});
        add(90, 180, {1, 0, 0});
        add(90, 90, {0, -1, 0});
        add(90, -90, {0, 1, 0});
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
    // Against itself the error is 0; against another seed it is that of both.
    const Answer again =
        taken(furnace(), "-o " + path("again") + " --samples 400 --seed 2 --json --reference " +
                             path("out/eye.exr"));
    const double mse = Json::parse(again.out)["cameras"][0]["relative_mse"];
    EXPECT_GT(mse, 0);
    EXPECT_NEAR(mse, 2 * error * error, error * error);
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

}  // namespace
