// The plans of the example scenes, checked by an integration of their own: nothing here comes from
// the planner but the files that it wrote.

#include "places.h"
#include "program.h"
#include "unstated.h"

#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/catalog.h>

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <vector>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;
using Rgb = std::array<double, 3>;

const std::string scenes = test::sourceFolder() + "/examples/scenes/";

double angle(const Json& json, const char* key) {
    return radians(json.value(key, 0.0));
}
Rgb colour(const Json& json, const char* key) {
    if (!json.contains(key)) return {};
    if (json[key].is_number()) return {json[key], json[key], json[key]};
    return {json[key][0], json[key][1], json[key][2]};
}

/// Turned about y by theta, then about z by phi: what takes +z to (theta, phi).
Direction tilted(const Direction& d, double theta, double phi) {
    const double x = std::cos(theta) * d.x + std::sin(theta) * d.z;
    const double z = std::cos(theta) * d.z - std::sin(theta) * d.x;
    return rotateAboutZ({x, d.y, z}, phi);
}

/// From a surface's frame into the world.
Direction toWorld(const Direction& d, const Json& orientation) {
    const double theta = angle(orientation, "theta"), phi = angle(orientation, "phi");
    return tilted(rotateAboutZ(d, angle(orientation, "turn") - phi), theta, phi);
}

/// Radiance of one light in a direction of the world; in the frame of the light +z is its centre,
/// +x points down and +y along azimuth.
Rgb radianceOf(const Json& light, const Direction& world) {
    const std::string kind = light["kind"];
    if (kind == "sky") {
        Rgb rgb = colour(light, world.z >= 0 ? "radiance" : "ground");
        if (world.z >= 0 && light["model"] == "overcast") {
            for (double& value : rgb) value *= (1 + 2 * world.z) / 3;
        }
        return rgb;
    }
    const Direction turned = rotateAboutZ(world, -angle(light, "phi"));
    const Direction d = tilted(turned, -angle(light, "theta"), 0);
    if (kind == "disc") {
        const double radius = angle(light, "angular_diameter") / 2;
        if (polarAngle(d) > radius) return {};
        Rgb rgb = colour(light, light.contains("radiance") ? "radiance" : "irradiance");
        if (light.contains("irradiance")) {
            for (double& value : rgb) value /= pi * std::sin(radius) * std::sin(radius);
        }
        return rgb;
    }
    const bool inside = d.z > 0 && std::abs(d.y / d.z) <= std::tan(angle(light, "width") / 2) &&
                        std::abs(d.x / d.z) <= std::tan(angle(light, "height") / 2);
    return inside ? colour(light, "radiance") : Rgb{};
}

/// Midpoints of equal steps of theta and phi over the hemisphere, where there is light.
struct Light {
    std::vector<double> x, y, z;
    std::array<std::vector<double>, 3> weight;  ///< radiance cos(theta) d omega
};
Light lightOn(const Json& scene, const Json& orientation) {
    constexpr int rings = 130, azimuths = 520;
    Light light;
    for (int r = 0; r < rings; ++r) {
        const double theta = (r + 0.5) * pi / 2 / rings;
        const double solidAngle = std::sin(theta) * (pi / 2 / rings) * (2 * pi / azimuths);
        for (int j = 0; j < azimuths; ++j) {
            const Direction d = directionFromAngles(theta, (j + 0.25) * 2 * pi / azimuths);
            Rgb sum{};
            for (const Json& each : scene["lights"]) {
                const Rgb rgb = radianceOf(each, toWorld(d, orientation));
                for (std::size_t c = 0; c < 3; ++c) sum[c] += rgb[c];
            }
            if (sum[0] + sum[1] + sum[2] == 0) continue;
            light.x.push_back(d.x);
            light.y.push_back(d.y);
            light.z.push_back(d.z);
            for (std::size_t c = 0; c < 3; ++c)
                light.weight[c].push_back(sum[c] * d.z * solidAngle);
        }
    }
    return light;
}

Rgb outgoing(const Brdf& brdf, const Light& light, const Direction& wo) {
    const std::size_t count = light.x.size(), channels = brdf.channels().count();
    std::vector<double> f(channels * count);
    brdf.eval(wo, {light.x.data(), light.y.data(), light.z.data(), count}, f.data());
    Rgb sum{};
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < count; ++k) {
            sum[c] += light.weight[c][k] * f[(channels == 1 ? 0 : c * count) + k];
        }
    }
    return sum;
}

/// Relative L2 of outgoing radiance over the scene's views and the material's orientations.
double relativeError(const Json& scene, const Json& material, const Brdf& truth,
                     const Brdf& approximation) {
    const double low = radians(scene["views"]["theta"][0]);
    const double high = radians(scene["views"]["theta"][1]);
    const Json upright = Json::array({{{"theta", 0}}});
    double error = 0, norm = 0;
    for (const Json& orientation : material.value("orientations", upright)) {
        const Light light = lightOn(scene, orientation);
        for (int k = 0; k < 28; ++k) {
            // Uniform in cos(theta): each view stands for the same solid angle.
            const double share = (k + 0.5) / 28;
            const double theta =
                std::acos(std::cos(low) + share * (std::cos(high) - std::cos(low)));
            const Direction wo = directionFromAngles(theta, k * std::sqrt(5.0) * pi);
            const Rgb a = outgoing(truth, light, wo), b = outgoing(approximation, light, wo);
            for (std::size_t c = 0; c < 3; ++c) {
                error += (a[c] - b[c]) * (a[c] - b[c]);
                norm += a[c] * a[c];
            }
        }
    }
    return std::sqrt(error / norm);
}

/// Errors of materials without coefficients by this test's integration, and the model itself, which
/// has none.
void expectFormulas(const Json& scene, const Json& material, const Json& formulas, double budget,
                    bool planned) {
    const auto truth = brdfs::open(std::string(material["brdf"]));
    bool itself = false;
    for (const Json& formula : formulas) {
        const auto brdf = brdfs::open(std::string(formula["spec"]));
        const double error = relativeError(scene, material, *truth, *brdf);
        const double stated = formula["verified_error"];
        EXPECT_NEAR(error, stated, 0.2 * std::max(stated, budget)) << formula["name"];
        EXPECT_EQ(formula["within"], std::max<double>(stated, formula["error"]) <= budget);
        if (formula["kind"] != "model") continue;
        EXPECT_EQ(stated, 0);
        itself = true;
    }
    EXPECT_EQ(itself, planned);  // light that is not resolved measures nothing
}

class PlanCommand : public Cli {
protected:
    /// Plans an example, holds every material to its budget and size, and returns the report.
    Json expectKept(const std::string& name, int code) {
        const std::string file = scenes + name + ".json";
        const Answer answer = run("plan " + file + " -o " + path("plan") + " --json");
        EXPECT_EQ(answer.code, code) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "plan"));
        EXPECT_TRUE(keepsSchema(read(file), "scene"));
        EXPECT_EQ(answer.out, unstated(read(path("plan/plan.json"))));
        EXPECT_NE(answer.err.find(": so far "), std::string::npos) << answer.err;
        const Json report = Json::parse(answer.out), scene = Json::parse(read(file));
        const double budget = scene["budget"]["error"];
        for (std::size_t k = 0; k < report["materials"].size(); ++k) {
            const Json& material = report["materials"][k];
            const std::string written = path("plan/" + std::string(material["name"]) + ".json");
            EXPECT_EQ(fs::exists(written), material["planned"]) << material["name"];
            expectFormulas(scene, scene["materials"][k], material["formulas"], budget,
                           material["planned"]);
            if (!material["planned"]) continue;
            const Representation kept = readRepresentation(written);
            EXPECT_EQ(kept.bytes(), material["choice"]["bytes"]);
            EXPECT_LE(5 * kept.bytes(), 32U * 32 * 3 * 100 * 4) << material["name"];
            const auto open = [](const std::string& spec) { return brdfs::open(spec); };
            const std::string spec = material["brdf"];
            const double error =
                relativeError(scene, scene["materials"][k], *open(spec), *reconstruct(kept, open));
            EXPECT_LE(error, budget) << material["name"];
            std::printf("%s: %zu bytes, %.4f by this test, %.4f by the program\n",
                        std::string(material["name"]).c_str(), kept.bytes(), error,
                        material["choice"]["verified_error"].get<double>());
        }
        return report;
    }
};

TEST_F(PlanCommand, MatteRoomKeepsItsBudgetAndRefusesTheMirror) {
    const Json report = expectKept("matte_room", 4);
    const Json& mirror = report["materials"].back();
    EXPECT_EQ(mirror["name"], "mirror");
    EXPECT_FALSE(mirror["planned"]);
    EXPECT_GE(mirror["instead"].size(), 2U);
    EXPECT_TRUE(fs::exists(path("plan/plan.html")));
    EXPECT_TRUE(fs::exists(path("plan/plan.csv")));
    // The command that the report names makes the same file.
    const Json& choice = report["materials"][0]["choice"];
    std::string command = choice["command"];
    ASSERT_EQ(command.find("hshfit "), 0U);
    command = command.substr(7, command.rfind(" -o ") - 7);
    ASSERT_EQ(run(command + " -o " + path("again.json")).code, 0);
    EXPECT_EQ(unstated(read(path("again.json"))), unstated(read(path("plan/plaster.json"))));
    // And a second run the same plan.
    const Answer second =
        run("plan " + scenes + "matte_room.json -o " + path("second") + " --json");
    EXPECT_EQ(second.out, unstated(read(path("plan/plan.json"))));
    EXPECT_EQ(unstated(read(path("second/plaster.json"))),
              unstated(read(path("plan/plaster.json"))));
}

TEST_F(PlanCommand, CarPaintKeepsItsBudget) {
    expectKept("car_paint", 0);
}

TEST_F(PlanCommand, BrushedMetalKeepsItsBudget) {
    expectKept("brushed_metal", 0);
}

/// A floor that a camera sees from straight above, and a material of nothing.
TEST_F(PlanCommand, CamerasGiveOrientationsAndViews) {
    const Json scene = {{"format", "hshfit-scene"},
                        {"version", 1},
                        {"materials",
                         {{{"name", "floor"}, {"brdf", "phong:exponent=3"}},
                          {{"name", "spare"}, {"brdf", "lambert"}}}},
                        {"lights", {{{"light", "uniform:radiance=1"}}}},
                        {"objects", {{{"mesh", "square"}, {"material", "floor"}}}},
                        {"cameras",
                         {{{"name", "top"},
                           {"position", {0, 0, 4}},
                           {"target", {0, 0, 0}},
                           {"up", {0, 1, 0}},
                           {"field_of_view", 20}}}},
                        {"budget", {{"error", 0.1}}}};
    write("scene.json", scene.dump());
    const Answer answer =
        run("plan " + path("scene.json") + " --force -o " + path("out") + " --max-order 3 --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "plan"));
    const Json materials = Json::parse(answer.out)["materials"];
    const Json seen = materials[0]["seen"];
    EXPECT_EQ(seen["share"], 1);
    EXPECT_EQ(materials[0]["orientations"], 1);
    ASSERT_EQ(seen["orientations"].size(), 1u);
    EXPECT_NEAR(seen["orientations"][0]["theta"], 0, 1e-6);
    // The corner of a square picture is seen at this angle.
    EXPECT_LE(seen["views"]["theta"][1],
              std::atan(std::sqrt(2.0) * std::tan(10 * M_PI / 180)) * 180 / M_PI);
    EXPECT_GT(seen["views"]["theta"][1], 10);
    EXPECT_EQ(materials[1]["seen"]["hits"], 0);
    EXPECT_FALSE(materials[1]["seen"].contains("views"));
    EXPECT_NE(run("plan " + path("scene.json") + " --force -o " + path("out") + " --max-order 3")
                  .out.find("no camera sees it"),
              std::string::npos);
}

TEST_F(PlanCommand, ErrorsAreOneLine) {
    expectError("plan absent.json -o " + path("out"), 3, "absent.json", 0);
    write("scene.json", R"({"format": "hshfit-scene", "version": 1, "lamps": []})");
    expectError("plan " + path("scene.json") + " -o " + path("out"), 3,
                "'lamps' is not known; valid: format", 1);
    expectError("plan " + scenes + "matte_room.json -o " + path("out") + " --bases lsosh", 2,
                "lsosh is not orthonormal", 1);
    expectError("plan " + scenes + "matte_room.json -o " + path("out") + " --bases hhs", 2,
                "unknown basis 'hhs'", 1);
}

}  // namespace
}  // namespace hshfit::test
