// Scenes with something wrong in them: each ends in one line and exit code 3, or in a right
// picture.

#include "scenes.h"

#include <cli/program.h>

#include <hshfit/pictures/rgb_picture.h>

#include <nlohmann/json.hpp>

#include <fstream>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

constexpr const char* triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

class BadScenes : public Cli {
protected:
    /// A floor that emits nothing below an even sky, seen from above.
    static Json floor(const std::string& mesh) {
        return {{"format", "hshfit-scene"},
                {"version", 1},
                {"materials", {{{"name", "grey"}, {"brdf", "lambert:kd=.5"}}}},
                {"objects", {{{"name", "thing"}, {"mesh", mesh}, {"material", "grey"}}}},
                {"lights", {{{"light", "uniform:radiance=1"}}}},
                {"cameras",
                 {{{"name", "eye"},
                   {"position", {0.2, 0.2, 3}},
                   {"target", {0.2, 0.2, 0}},
                   {"up", {0, 1, 0}},
                   {"field_of_view", 5},
                   {"width", 4}}}}};
    }
    Answer taken(const Json& scene, const std::string& more = "", int samples = 64) const {
        std::ofstream(path("scene.json")) << scene;
        return run("illuminate " + path("scene.json") + " -o " + path("out") + " --samples " +
                   std::to_string(samples) + " " + more);
    }
    void refuses(const Json& scene, const std::vector<std::string>& parts) const {
        const Answer answer = taken(scene);
        EXPECT_EQ(answer.code, 3) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
        for (const std::string& part : parts)
            EXPECT_NE(answer.err.find(part), std::string::npos) << answer.err << " lacks " << part;
        EXPECT_FALSE(std::filesystem::exists(path("out")));
    }
    /// Every pixel has the radiance.
    void shows(const Json& scene, double radiance, double tolerance) const {
        const Answer answer = taken(scene, "--force", 1024);
        ASSERT_EQ(answer.code, 0) << answer.err;
        for (const float value : hshfit::readRgbExr(path("out/eye.exr")).values)
            EXPECT_NEAR(value, radiance, tolerance);
    }
};

TEST_F(BadScenes, WithBrokenMeshesAreRefused) {
    refuses(floor("absent.obj"), {"absent.obj", "No such file"});
    write("empty.obj", "");
    refuses(floor("empty.obj"), {"empty.obj", "is empty"});
    write("nothing.obj", "# an object without faces\nv 0 0 0\n");
    refuses(floor("nothing.obj"), {"nothing.obj", "no faces"});
    write("words.obj", "v 0 0 zero\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    refuses(floor("words.obj"), {"words.obj", "line 1", "zero"});
    write("nan.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
          "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "0 0 0 0 0 1\n1 0 0 0 0 nan\n0 1 0 0 0 1\n3 0 1 2\n");
    refuses(floor("nan.ply"), {"nan.ply", "normal of corner 1", "nan"});
    write("inf.obj", "v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n");
    refuses(floor("inf.obj"), {"inf.obj", "vertex 1", "finite"});
    write("line.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
    refuses(floor("line.obj"), {"line.obj", "area"});
    Json lit = floor("line.obj");
    lit["objects"][0]["emission"] = 5;
    refuses(lit, {"line.obj", "area"});
    write("cut.glb", std::string("glTF\2\0\0\0", 8));
    refuses(floor("cut.glb"), {"cut.glb", "header"});
}

TEST_F(BadScenes, WithBadPlacesAreRefused) {
    write("triangle.obj", triangle);
    for (const Json& scale : {Json(-1), Json({1, -1, 1}), Json(0), Json(1e-9)}) {
        Json scene = floor("triangle.obj");
        scene["objects"][0]["scale"] = scale;
        refuses(scene, {"'objects[0].scale'", "from 1e-6 to 1e+06"});
    }
    Json lost = floor("triangle.obj");
    lost["objects"][0]["scale"] = 1e-6;
    lost["objects"][0]["at"] = {1e6, 1e6, 1e6};
    refuses(lost, {"scene.json", "'thing'", "none of its triangles has an area"});
    write("vast.obj", "v 0 0 0\nv 1e14 0 0\nv 0 1e14 0\nf 1 2 3\n");
    Json vast = floor("vast.obj");
    vast["objects"][0]["scale"] = 1e6;
    refuses(vast, {"scene.json", "'thing'", "1e+20", "at most 1e+15"});
    Json missing = floor("square");
    missing["objects"][0].erase("material");
    refuses(missing, {"'objects[0].material' is missing"});
    Json other = floor("square");
    other["objects"][0]["material"] = "gold";
    refuses(other, {"'objects[0].material' is 'gold'; valid: grey"});
    // Coefficients of light have keys of their own; the kind of file is the mistake.
    refuses({{"format", "hshfit-light"}, {"basis", "sh"}}, {"'format' is 'hshfit-light'; valid: "
                                                            "hshfit-scene"});
    Json unknown = floor("square");
    unknown["materials"][0]["brdf"] = "absent.binary";
    refuses(unknown, {"absent.binary"});
}

/// Triangles without area are left out, and the others are seen: 0.5 of an even sky of 1.
TEST_F(BadScenes, WithSomeDegenerateTrianglesShowTheOthers) {
    write("mixed.obj", "v -9 -9 0\nv 9 -9 0\nv 0 9 0\nv 5 0 0\nf 1 2 3\nf 1 4 4\nf 1 1 1\n");
    Json scene = floor("mixed.obj");
    const Answer answer = taken(scene, "--json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(Json::parse(answer.out)["triangles"], 1);
    EXPECT_EQ(Json::parse(answer.out)["degenerate"], 2);
    shows(scene, 0.5, 0.01);
}

/// Normals of length 0 are computed.
TEST_F(BadScenes, WithoutUsableNormalsShowTheSurface) {
    write("dark.obj", "v -9 -9 0\nv 9 -9 0\nv 0 9 0\nvn 0 0 0\nf 1//1 2//1 3//1\n");
    shows(floor("dark.obj"), 0.5, 0.01);
}

/// A closed room whose walls are there twice emits what one set of walls does: E / (1 - rho).
TEST_F(BadScenes, WithCoincidentWallsShowOneOfThem) {
    for (const int copies : {1, 2}) {
        Json room = floor("square");
        room.erase("lights");
        room["cameras"][0]["position"] = {0.1, 0.2, 0.3};
        room["objects"] = Json::array();
        for (int copy = 0; copy < copies; ++copy) hshfit::test::addFurnace(room["objects"]);
        shows(room, 2, 0.12);
    }
}

/// Inside of a solid there is no light, which is remarked on.
TEST_F(BadScenes, WithTheCameraInsideOfAnObjectAreDark) {
    Json scene = floor("sphere");
    scene["cameras"][0]["position"] = {0, 0, 0.5};
    const Answer answer = taken(scene);
    ASSERT_EQ(answer.code, 0);
    EXPECT_NE((answer.err + answer.out).find("camera 'eye' sees no light"), std::string::npos)
        << answer.err;
    shows(scene, 0, 0);
    // A camera in the plane of a wall sees the wall or the things behind it.
    Json within = floor("square");
    within["cameras"][0]["position"] = {0.2, 0.2, 0};
    within["cameras"][0]["target"] = {0.2, 0.2, -1};
    EXPECT_EQ(taken(within, "--force").code, 0);
}

}  // namespace
