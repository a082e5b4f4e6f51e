// `info` and `list` of lights, and scenes of `plan` with them.

#include "lib/light/hosek_wilkie_file.h"
#include "places.h"
#include "program.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

constexpr double pi = 3.14159265358979323846;

class Lights : public Cli {
protected:
    Json info(const std::string& spec) const {
        const Answer answer = run("info --json '" + spec + "'");
        EXPECT_EQ(answer.code, 0) << spec << "\n" << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "info")) << spec;
        return answer.code == 0 ? Json::parse(answer.out) : Json();
    }

    /// A PFM file of grey values by row from the bottom, or with one R, G and B for each pixel.
    std::string pfm(const std::string& name, int width, int height,
                    const std::vector<float>& rgb) const {
        std::ofstream out(path(name), std::ios::binary);
        out << "PF\n" << width << " " << height << "\n-1.0\n";
        out.write(reinterpret_cast<const char*>(rgb.data()),
                  static_cast<std::streamsize>(rgb.size() * sizeof(float)));
        return path(name);
    }
};

TEST_F(Lights, MixedAnalyticLightsHaveAHealthReport) {
    const Json document = info("sky:type=12,elevation=40+sun:elevation=40,irradiance=3");
    EXPECT_EQ(document["kind"], "light");
    EXPECT_EQ(document["lights"].size(), 2U);
    const Json& health = document["light_health"];
    // The sun: radiance E / (pi sin^2 r) above a sky of about 1, in 0.1 % of the sphere.
    const double radius = 0.533 / 2 * pi / 180;
    const double sun = 3 / (pi * std::pow(std::sin(radius), 2));
    EXPECT_NEAR(health["peak"][0], sun, 1e-2 * sun);
    EXPECT_NEAR(health["peak_direction"]["elevation"], 40, 0.01);
    EXPECT_FALSE(health["clipped_by_half"]);
    EXPECT_TRUE(info("sun:elevation=40,irradiance=50")["light_health"]["clipped_by_half"]);
    EXPECT_NEAR(health["black_share"], 0.5, 1e-3);

    const Json uniform = info("uniform:radiance=2/1/0")["light_health"];
    EXPECT_NEAR(uniform["mean"][0], 2, 1e-9);
    EXPECT_NEAR(uniform["mean"][2], 0, 1e-9);
    EXPECT_NEAR(uniform["brightest_share"], 1e-3, 1e-6);
    EXPECT_NEAR(uniform["dynamic_range"], 1, 1e-12);

    // All flux in a disc of 0.07 sr or in one direction.
    EXPECT_NEAR(info("sun:elevation=40")["light_health"]["brightest_share"], 1, 1e-9);
    const Json beam = info("directional:elevation=90,irradiance=3")["light_health"];
    EXPECT_TRUE(beam["peak"][0].is_null());
    EXPECT_NEAR(beam["mean"][0], 3 / (4 * pi), 1e-12);
    // A wide sun and a panel before a uniform sky: mean radiance and black share follow from their
    // solid angles, 2 pi (1 - cos r) and 4 atan(a b / sqrt(1 + a^2 + b^2)).
    const double cap = 2 * pi * (1 - std::cos(10 * pi / 180));
    const Json disc = info("sun:elevation=35,azimuth=77,angle=20,radiance=5")["light_health"];
    EXPECT_NEAR(disc["mean"][0], 5 * cap / (4 * pi), 1e-12);
    EXPECT_NEAR(disc["black_share"], 1 - cap / (4 * pi), 1e-5);
    const double a = std::tan(15 * pi / 180), b = std::tan(5 * pi / 180);
    const double panel = 4 * std::atan(a * b / std::sqrt(1 + a * a + b * b));
    const Json both =
        info("panel:elevation=20,width=30,height=10,radiance=3+uniform:radiance=1")["light_health"];
    EXPECT_NEAR(both["mean"][1], 1 + 3 * panel / (4 * pi), 1e-6);
    EXPECT_NEAR(both["dynamic_range"], 4, 1e-12);
    const Json strip = info("panel:elevation=20,width=80,height=0.01,radiance=3")["light_health"];
    EXPECT_GT(strip["mean"][1].get<double>(), 0);

    const std::string text = run("info 'sky:type=3+sun:elevation=30'").out;
    for (const char* words : {"light:", "mean radiance", "peak towards", "fits a 16-bit float"}) {
        EXPECT_NE(text.find(words), std::string::npos) << words;
    }
}

/// Ten bands of a beam of irradiance E are E / (4 pi) times the sum of (2 l + 1) P_l of the cosine
/// towards it, which is below 0 in about half of the sphere.
TEST_F(Lights, RingingOfCoefficientsIsBelow0AndNotBlack) {
    ASSERT_EQ(run("light directional:elevation=40,irradiance=3 -o " + path("beam.json")).code, 0);
    constexpr int steps = 200000;
    double share = 0, least = 0;
    for (int k = 0; k < steps; ++k) {
        const double x = -1 + 2 * (k + 0.5) / steps;
        double sum = 0;
        for (unsigned l = 0; l < 10; ++l) sum += (2 * l + 1) * std::legendre(l, x);
        least = std::min(least, 3 / (4 * pi) * sum);
        if (sum < 0) share += 1.0 / steps;
    }
    const Json health = info(path("beam.json"))["light_health"];
    EXPECT_NEAR(health["negative_share"], share, 1e-3);
    EXPECT_NEAR(health["least_negative"], least, 1e-3 * -least);
    EXPECT_EQ(health["black_share"], 0);
    EXPECT_NEAR(health["mean"][0], 3 / (4 * pi), 1e-4);

    const std::string text = run("info " + path("beam.json")).out;
    EXPECT_NE(text.find("% of the sphere, down to -"), std::string::npos) << text;
    EXPECT_EQ(text.find("black"), std::string::npos) << text;
    EXPECT_EQ(text.find("pixels below 0"), std::string::npos) << text;
    // The least value above 0 on a grid is an accident where radiance goes through 0.
    EXPECT_EQ(health["dynamic_range"], 0);
    EXPECT_EQ(text.find("dynamic range"), std::string::npos) << text;
}

TEST_F(Lights, RadianceThatHalfFloatsTurnTo0DoesNotFitThem) {
    for (const double value : {1e-40, 1e-7, 1.0, 1e5}) {
        const std::vector<float> rgb(3 * 64 * 32, static_cast<float>(value));
        const std::string file = pfm("dark.pfm", 64, 32, rgb);
        const Json health = info(file)["light_health"];
        EXPECT_EQ(health["black_in_half"], value < 0x1p-25) << value;
        EXPECT_EQ(health["clipped_by_half"], value > 65504) << value;
        const bool fits = value > 0x1p-25 && value < 65504;
        const std::string text = run("info " + file).out;
        EXPECT_EQ(text.find("fits a 16-bit float          yes") != std::string::npos, fits) << text;
    }
}

TEST_F(Lights, PicturesHaveTheHealthOfTheirPixels) {
    // 64 x 32, 1 everywhere but for one pixel of 70000 next to the horizon.
    std::vector<float> rgb(3 * 64 * 32, 1.F);
    for (int c = 0; c < 3; ++c) rgb[3 * (16 * 64 + 32) + c] = 70000;
    const std::string file = pfm("a.pfm", 64, 32, rgb);
    const Json document = info(file);
    EXPECT_EQ(document["lights"][0]["layout"], "latlong");
    EXPECT_EQ(document["lights"][0]["width"], 64);
    const Json& health = document["light_health"];
    const double step = pi / 32, omega = (std::cos(15 * step) - std::cos(16 * step)) * 2 * pi / 64;
    const double flux = 70000 * omega + (4 * pi - omega);
    EXPECT_NEAR(health["mean"][1], flux / (4 * pi), 1e-6 * flux);
    EXPECT_NEAR(health["brightest_share"], (70000 * omega + (4e-3 * pi - omega)) / flux, 0.01);
    EXPECT_NEAR(health["dynamic_range"], 70000, 1e-3);
    EXPECT_TRUE(health["clipped_by_half"]);
    EXPECT_NEAR(health["peak_direction"]["elevation"], 90.0 / 32, 1e-3);
    EXPECT_NEAR(health["peak_direction"]["azimuth"], -180.0 / 64, 1e-3);
    EXPECT_NEAR(info(file + ":turn=30")["light_health"]["peak_direction"]["azimuth"],
                30 - 180.0 / 64, 1e-3);

    rgb[7] = -1;
    rgb[100] = std::numeric_limits<float>::quiet_NaN();
    const Json broken = info(pfm("b.pfm", 64, 32, rgb));
    EXPECT_EQ(broken["light_health"]["invalid"]["negative"], 1);
    EXPECT_EQ(broken["light_health"]["invalid"]["nan"], 1);
    EXPECT_TRUE(broken.contains("warnings"));
}

TEST_F(Lights, WholeNumbersThatAreRadianceAreReadAgainAsThat) {
    write("codes.ppm", "P6\n4 2\n255\n" + std::string(3 * 4 * 2, '\x66'));
    const Json document = info(path("codes.ppm") + ":curve=linear");
    EXPECT_NEAR(document["light_health"]["mean"][0], 0x66 / 255.0, 1e-6);
}

TEST_F(Lights, BrokenPicturesEndInThreeWithOneLine) {
    const std::vector<float> rgb(3 * 16 * 8, 1.F);
    const auto three = [&](const std::string& spec, const std::string& words) {
        const Answer answer = run("info '" + spec + "'");
        EXPECT_EQ(answer.code, 3) << spec;
        EXPECT_NE(answer.err.find(words), std::string::npos) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
    };
    const std::string good = pfm("good.pfm", 16, 8, rgb);
    for (const char* layout : {"angular", "mirror-ball", "cross", "faces"}) {
        three(good + ":layout=" + layout, layout);
    }
    const std::string cut = pfm("cut.pfm", 16, 8, std::vector<float>(100, 1.F));
    three(cut, cut);
    three(pfm("odd.pfm", 17, 8, std::vector<float>(3 * 17 * 8, 1.F)), "do not tell a layout");
    three(good + ":curve=srgb", "linear");
    EXPECT_EQ(run("info '" + good + ":layout=flat'").code, 2);
    EXPECT_EQ(run("info 'sky:type=16'").code, 2);
}

TEST_F(Lights, SharedMapsAreLightsAndTablesAreNot) {
    const std::string env = sharedFolder() + "/data/env/";
    if (!fs::exists(env)) GTEST_SKIP() << env << " is not there";
    EXPECT_EQ(info(env + "rnl_probe_latlong.hdr")["kind"], "light");
    EXPECT_EQ(info(env + "grace_probe_angular.hdr:layout=angular")["lights"][0]["layout"],
              "angular");
    EXPECT_EQ(run("info " + env + "grace_probe_angular.hdr").code, 3);
    // A table of a BRDF written as a picture stays one.
    EXPECT_EQ(run("convert lambert " + path("x.exr") + " --to slices:size=8").code, 0);
    EXPECT_EQ(info(path("x.exr"))["kind"], "brdf");
}

/// A square picture may be a probe as well as a table. A table of hshfit says that it is one.
TEST_F(Lights, PicturesThatDoNotSayWhatTheyHoldAreSaidToBeTakenAsTables) {
    const std::string picture = path("probe.exr"), table = path("table.exr");
    ASSERT_EQ(run("render lambert --light uniform --by integration --size 8 -o " + picture).code,
              0);
    ASSERT_EQ(run("convert lambert " + table + " --to slices:size=8").code, 0);
    const Json taken = info(picture);
    EXPECT_EQ(taken["kind"], "brdf");
    EXPECT_NE(taken["facts"].value("taken_as", "").find("FILE:layout=angular"), std::string::npos);
    EXPECT_FALSE(info(table)["facts"].contains("taken_as"));
    EXPECT_EQ(info(picture + ":layout=angular")["kind"], "light");
}

TEST_F(Lights, ConventionsStateTheirHandInOneWord) {
    const Answer answer = run("irradiance uniform --convention all --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json document = Json::parse(answer.out);
    ASSERT_GT(document["conventions"].size(), 9U);
    for (const Json& each : document["conventions"])
        EXPECT_TRUE(each["handedness"] == "left" || each["handedness"] == "right") << each["name"];
}

TEST_F(Lights, TheListHasEveryKindAndKeepsItsSchema) {
    const Answer answer = run("list lights --json");
    EXPECT_TRUE(keepsSchema(answer.out, "list"));
    const Json rows = Json::parse(answer.out)["lights"];
    const auto named = [&](const char* name) {
        return std::any_of(rows.begin(), rows.end(),
                           [&](const Json& row) { return row["name"] == name; });
    };
    for (const char* name : {"sun", "panel", "sky", "preetham", "perez", "uniform", "hosek-wilkie"})
        EXPECT_TRUE(named(name)) << name;
    const std::string text = run("list lights").out;
    for (const char* words : {"preetham", "turbidity", "layout", "such as 2024-06-21", "sums"}) {
        EXPECT_NE(text.find(words), std::string::npos) << words;
    }
}

/// Tables with C = 1 and no other coefficient give a uniform dome of radiance L, whose coefficients
/// are 2 pi L / sqrt(4 pi) and pi L sqrt(3 / (4 pi)).
TEST_F(Lights, ASkyByTablesIsALightOfEveryCommand) {
    const std::string data = path("ArHosekSkyModelData_RGB.h");
    const std::string tables = hosekWilkieFile("RGB", [](const HosekWilkiePlace& place) {
        return place.coefficient == 9 ? 2.0 + place.channel : place.coefficient == 2 ? 1.0 : 0.0;
    });
    std::ofstream(data) << tables;
    const std::string sky = "hosek-wilkie:data=" + data + ",elevation=40,albedo=0.2";
    const Json nine = Json::parse(run("irradiance " + sky + " --json").out)["radiance"];
    for (std::size_t c = 0; c < 3; ++c) {
        const double radiance = 0.683 * (2 + static_cast<double>(c));
        EXPECT_NEAR(nine[0][c], 2 * pi * radiance / std::sqrt(4 * pi), 1e-6);
        EXPECT_NEAR(nine[2][c], pi * radiance * std::sqrt(3 / (4 * pi)), 1e-6);
        EXPECT_NEAR(nine[1][c], 0, 1e-6);
    }
    EXPECT_EQ(info(sky)["lights"][0]["model"], "hosek-wilkie");
    EXPECT_EQ(run("light " + sky + " --order 3 -o " + path("sky.json")).code, 0);
    EXPECT_EQ(
        run("render lambert --light '" + sky + "+uniform:' --size 8 -o " + path("s.png")).code, 0);
    // A file that breaks off, one of another kind, and none.
    std::ofstream(path("half.h")) << tables.substr(0, tables.size() / 2);
    std::ofstream(path("other.h")) << "int main() {}\n";
    for (const auto& [name, words] : {std::pair("half.h", "the file ends within the array"),
                                      {"other.h", "has no tables of the Hosek-Wilkie sky"},
                                      {"none.h", "none.h"}}) {
        const std::string wrong = "hosek-wilkie:elevation=40,data=" + path(name);
        const Answer answer = run("light " + wrong + " -o " + path("wrong.json"));
        EXPECT_EQ(answer.code, 3) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
        EXPECT_NE(answer.err.find(words), std::string::npos) << answer.err;
        EXPECT_FALSE(fs::exists(path("wrong.json")));
    }
    EXPECT_EQ(run("light " + sky + ",turbidity=11 -o " + path("wrong.json")).code, 2);
}

TEST_F(Lights, FilesOfCoefficientsAreLights) {
    const std::string file = path("sky.json");
    ASSERT_EQ(run("light sky:type=12,elevation=40 --order 4 -o " + file).code, 0);
    const Json document = info(file + ":turn=20");
    EXPECT_EQ(document["kind"], "light");
    EXPECT_EQ(document["lights"][0]["kind"], "coefficients");
    EXPECT_EQ(document["lights"][0]["order"], 4);
    ASSERT_EQ(run("rotate " + file + " --force -o " + path("turned.json") + " --euler 20,0,0").code,
              0);
    EXPECT_EQ(info(path("turned.json"))["lights"][0]["domain"], "sphere");

    // The nine coefficients of the file are the sky's; a file that was turned, and a turn of the
    // file, give the same.
    const auto nine = [&](const std::string& spec) {
        const Answer answer = run("irradiance --normals 64 --json '" + spec + "'");
        EXPECT_EQ(answer.code, 0) << answer.err;
        return answer.code == 0 ? Json::parse(answer.out) : Json();
    };
    const Json sky = nine("sky:type=12,elevation=40"), read = nine(file);
    const Json turned = nine(path("turned.json")), turn = nine(file + ":turn=20");
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(read["radiance"][k][c], sky["radiance"][k][c], 1e-6);
            EXPECT_NEAR(turned["radiance"][k][c], turn["radiance"][k][c], 1e-12);
        }
    // Light of four bands is met by irradiance of four bands.
    const Answer four = run("irradiance --order 4 --normals 64 --json " + file);
    ASSERT_EQ(four.code, 0) << four.err;
    EXPECT_LT(Json::parse(four.out)["error"]["maximum"], 1e-6);

    const Answer rendered =
        run("render lambert --size 16 --samples 1 --orders 2 --cosine --light " + file +
            " --json --force -o " + path("a.exr"));
    ASSERT_EQ(rendered.code, 0) << rendered.err;
    EXPECT_LT(Json::parse(rendered.out)["pictures"][1]["relative_l2"], 1e-3);
}

// A beam whose azimuth is turned by hand, and numbers that are read back.
TEST_F(Lights, IrradianceForAnEngineIsThatOfTurnedLight) {
    const auto answerOf = [&](const std::string& words) {
        const Answer answer = run("irradiance --normals 16 --json " + words);
        EXPECT_EQ(answer.code, 0) << answer.err;
        if (answer.code != 0) return Json();
        EXPECT_TRUE(keepsSchema(answer.out, "irradiance"));
        return Json::parse(answer.out);
    };
    const auto beam = [](int azimuth) {
        return "directional:elevation=40,irradiance=2,azimuth=" + std::to_string(azimuth);
    };
    for (const auto& [engine, turn] :
         {std::pair("filament", -90), std::pair("unreal", 90), std::pair("three", 0)}) {
        const Json own = answerOf(beam(25) + " --for " + engine);
        EXPECT_EQ(own["turn"], turn);
        ASSERT_EQ(own["conventions"].size(), 1U);
        const Json byHand = answerOf(beam(25 + turn) + " --convention " + std::string(engine));
        std::string numbers;
        const Json &ours = own["conventions"][0]["values"],
                   &theirs = byHand["conventions"][0]["values"];
        ASSERT_EQ(ours.size(), theirs.size());
        for (std::size_t row = 0; row < ours.size(); ++row)
            for (std::size_t k = 0; k < ours[row].size(); ++k) {
                EXPECT_NEAR(ours[row][k], theirs[row][k], 1e-12) << engine;
                numbers += ours[row][k].dump() + "\n";
            }
        write("nine.txt", numbers);
        const Json back = answerOf(path("nine.txt") + ":for=" + engine),
                   first = answerOf(beam(25) + " --convention three");
        for (std::size_t slot = 0; slot < 9; ++slot)
            EXPECT_NEAR(back["radiance"][slot][0], first["radiance"][slot][0], 1e-5) << engine;
    }
    expectError("irradiance uniform --for unrael", 2, "unreal", 1);
    expectError("irradiance uniform --for unreal --convention three", 2, "--for", 1);
}

TEST_F(Lights, LightComparesWithItsBestWavelets) {
    const Answer answer =
        run("light panel:elevation=50,width=30,height=20 --order 8 --wavelets --json -o " +
            path("p.json"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "light"));
    const Json curves = Json::parse(answer.out)["curves"];
    ASSERT_EQ(curves.size(), 2U);
    EXPECT_EQ(curves[1]["basis"], "soho");
    EXPECT_EQ(curves[1]["selection"], "best_terms");
    ASSERT_EQ(curves[1]["points"].size(), 8U);
    // Edges are for wavelets: 64 of the best against 64 harmonics.
    EXPECT_GT(curves[1]["points"][7]["accuracy"], curves[0]["points"][7]["accuracy"]);
    EXPECT_LE(curves[1]["points"][7]["accuracy"], 1);
    EXPECT_LT(curves[1]["error"], 0.02);
}

TEST_F(Lights, ASunIsSplitOffAPicture) {
    // A sun of one pixel, and one without.
    std::vector<float> rgb(3 * 64 * 32, 1.0F);
    const std::string plain = pfm("plain.pfm", 64, 32, rgb);
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * (20 * 64 + 10) + c] = 5e4F;
    const std::string sun = pfm("sun.pfm", 64, 32, rgb);
    const Answer answer =
        run("light " + sun + ":turn=20,scale=2 --split-sun -o " + path("day.json") + " --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "light"));
    const Json split = Json::parse(answer.out)["split"];
    // Row 20 from the bottom is row 11 from the top; a pixel has 5.625 degrees.
    EXPECT_NEAR(split["elevation"], 90 - 11.5 * 5.625, 0.1);
    EXPECT_NEAR(split["azimuth"], 180 - 10.5 * 5.625 + 20 - 0, 0.1);
    const double solidAngle = 2 * pi / 64 * (std::cos(11 * pi / 32) - std::cos(12 * pi / 32));
    EXPECT_NEAR(split["irradiance"][1], 2 * (5e4 - 1) * solidAngle, 2e-3 * 2 * 5e4 * solidAngle);
    EXPECT_LT(split["mean_error"], 1e-6);
    EXPECT_LT(split["error"], 0.03);
    EXPECT_EQ(split["rest"], path("day_rest.exr"));
    // The sum is a specification like any other.
    const auto irradiance = [&](const std::string& spec) {
        const Answer one = run("irradiance '" + spec + "' --json");
        EXPECT_EQ(one.code, 0) << one.err;
        return Json::parse(one.out)["irradiance"];
    };
    const Json whole = irradiance(sun + ":turn=20,scale=2");
    const Json sum = irradiance(split["specification"]);
    for (std::size_t k = 0; k < 4; ++k)
        EXPECT_NEAR(sum[k][0], whole[k][0], 1e-5 * whole[0][0].get<double>()) << k;
    expectError("light " + plain + " --split-sun -o " + path("x.json"), 3, "has no sun", 4);
    expectError("light uniform: --split-sun -o " + path("x.json"), 2, "one picture", 4);
    expectError("light " + sun + " uniform: --split-sun -o " + path("x.json"), 2, "a sum", 4);
}

TEST_F(Lights, CoefficientsOfTheOtherKindAreRefused) {
    ASSERT_EQ(run("light uniform --order 2 -o " + path("light.json")).code, 0);
    ASSERT_EQ(run("project lambert --order 2 --outgoing 4 -o " + path("brdf.json")).code, 0);
    const std::string light = path("light.json"), brdf = path("brdf.json"), out = path("o.png");
    expectError("irradiance " + brdf, 3, "of a BRDF", 2);
    expectError("render lambert --light " + brdf + " -o " + out, 3, "of a BRDF", 2);
    expectError("light " + brdf + " -o " + path("again.json"), 3, "of a BRDF", 2);
    expectError("render " + light + " --light uniform -o " + out, 3, "of light", 2);
    expectError("eval " + light + " --wi 0,0 --wo 0,0", 3, "of light", 2);
    expectError("report " + light + " --json", 3, "of light", 2);
}

/// The same plan by a lamp of the scene's own kind and by its specification; a picture in PFM.
TEST_F(Lights, ScenesTakeSpecificationsAndEveryFormat) {
    pfm("room.pfm", 16, 8, std::vector<float>(3 * 16 * 8, 0.5F));
    const auto plan = [&](const std::string& name, const std::string& lights) {
        std::ofstream(path(name + ".json"))
            << R"({"format": "hshfit-scene", "version": 1, "materials": [{"name": "grey", )"
            << R"("brdf": "lambert:kd=0.5"}], "lights": )" << lights
            << R"(, "budget": {"metric": "relative_l2", "error": 0.05}})";
        const Answer answer =
            run("plan " + path(name + ".json") + " -o " + path(name) + " --quiet --json");
        EXPECT_EQ(answer.code, 0) << answer.err;
        return answer;
    };
    const Answer own = plan("own", R"([{"kind": "disc", "theta": 30, "phi": 20,
        "angular_diameter": 10, "irradiance": 2}, {"kind": "environment", "file": "room.pfm"}])");
    const Answer spec = plan("spec", R"([{"light":
        "sun:elevation=60,azimuth=20,angle=10,irradiance=2 + room.pfm"}])");
    if (own.code != 0 || spec.code != 0) return;
    const Json a = Json::parse(own.out)["materials"][0], b = Json::parse(spec.out)["materials"][0];
    EXPECT_EQ(a["choice"]["bytes"], b["choice"]["bytes"]);
    EXPECT_EQ(a["choice"]["error"], b["choice"]["error"]);
    EXPECT_TRUE(a["choice"]["error"].is_number());

    // Coefficients of light are one too, found beside the scene.
    ASSERT_EQ(run("light " + path("room.pfm") + " --order 3 -o " + path("series.json")).code, 0);
    const Answer series = plan("by-series", R"([{"light": "series.json:scale=2"}])");
    EXPECT_TRUE(series.code != 0 ||
                Json::parse(series.out)["materials"][0]["choice"]["error"].is_number());

    std::ofstream(path("bad.json"))
        << R"({"format": "hshfit-scene", "version": 1, "materials": [{"name": "grey", )"
        << R"("brdf": "lambert"}], "lights": [{"light": "sky:type=77"}], )"
        << R"("budget": {"metric": "log", "error": 0.05}})";
    const Answer bad = run("plan " + path("bad.json") + " -o " + path("bad"));
    EXPECT_EQ(bad.code, 3);
    EXPECT_NE(bad.err.find("1 to 15"), std::string::npos) << bad.err;
}

/// The program says what is off, and the command that it names is better.
TEST_F(Lights, CoefficientsThatAreOffArePoor) {
    const std::string sky =
        "light sky:type=12,elevation=20,radiance=1 --normal 0,0 --order 14 --json";
    const Answer solved = run(sky + " --basis lsosh -o " + path("lsosh.json"));
    ASSERT_EQ(solved.code, 0) << solved.err;
    EXPECT_NE(solved.err.find("poor: the coefficients are off"), std::string::npos) << solved.err;
    EXPECT_NE(solved.err.find("--basis hsh"), std::string::npos) << solved.err;
    const Answer orthonormal = run(sky + " --basis hsh -o " + path("hsh.json"));
    ASSERT_EQ(orthonormal.code, 0) << orthonormal.err;
    EXPECT_EQ(orthonormal.err.find("poor"), std::string::npos) << orthonormal.err;
    EXPECT_LT(Json::parse(orthonormal.out)["error"].get<double>(),
              0.1 * Json::parse(solved.out)["error"].get<double>());
}

TEST_F(Lights, OneBandIsOne) {
    const Answer answer = run("light uniform:radiance=1 --order 1 -o " + path("one.json"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_NE(answer.out.find(": 1 band (1 slot)\n"), std::string::npos) << answer.out;
}

// The numbers and shaders of an answer hold three bands, whatever order is asked for.
TEST_F(Lights, IrradianceStatesTheErrorOfTheNumbersThatItPrints) {
    const std::string call = "irradiance sun:elevation=40,irradiance=3 --convention three --order ";
    const auto answerOf = [&](const std::string& order) {
        const Answer answer = run(call + order + " --json");
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "irradiance"));
        return Json::parse(answer.out);
    };
    const Json three = answerOf("3"), twenty = answerOf("20");
    for (std::size_t k = 0; k < 9; ++k)
        EXPECT_NEAR(three["irradiance"][k][0], twenty["irradiance"][k][0].get<double>(), 1e-9) << k;
    const double error = three["error"]["maximum"];
    EXPECT_NEAR(twenty["nine"]["error"]["maximum"], error, 1e-6 * error);
    EXPECT_LT(twenty["error"]["maximum"], 0.5 * error);
    // The text has both.
    const std::string said = fmt::format("error at most {:.3g} %", 100 * error);
    EXPECT_NE(run(call + "20").out.find("order 3, as below  108 bytes  " + said), std::string::npos)
        << said;
}

}  // namespace
}  // namespace hshfit::test
