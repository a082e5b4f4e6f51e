// `render`, and the page of `compare`, as a user meets them.

#include "places.h"

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

namespace fs = std::filesystem;

TEST_F(Cli, RenderHasHelpWhoseExampleWorks) {
    const std::string help = run("render --help").out;
    const std::size_t begin = help.find("Example:\n  hshfit ");
    ASSERT_NE(begin, std::string::npos);
    const std::string example = help.substr(begin + 18, help.find("\n", begin + 9) - begin - 18);
    const std::string line =
        "cd " + folder_.string() + " && " + hshfit::test::program() + " " + example + " >out 2>err";
    EXPECT_EQ(std::system(line.c_str()), 0) << read(path("err"));
    EXPECT_EQ(read(path("spheres.png")).substr(1, 3), "PNG");
}

/// Samples below 30 degrees: a sphere is black but for its middle.
TEST_F(Cli, RenderSaysThatDirectionsWereNotMeasured) {
    std::string samples = "theta_i,phi_i,theta_o,phi_o,f\n", everywhere = samples;
    for (int i = 0; i <= 85; i += 5)
        for (int o = 0; o <= 85; o += 5)
            for (int phi = 0; phi < 360; phi += 30) {
                const std::string line = std::to_string(i) + ",0," + std::to_string(o) + "," +
                                         std::to_string(phi) + ",0.3\n";
                everywhere += line;
                if (i <= 30 && o <= 30) samples += line;
            }
    write("few.csv", samples);
    write("all.csv", everywhere);
    const std::string few = path("few.csv"), all = path("all.csv");
    for (const std::string way : {"", " --by integration"}) {
        const Answer answer = run("render " + few + " --size 8" + way + " -o " + path("few.exr"));
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_NE(answer.err.find("were not measured, and are drawn black"), std::string::npos)
            << way << answer.err;
        fs::remove(path("few.exr"));
        EXPECT_EQ(run("render " + all + " --size 8" + way + " -o " + path("all.exr")).err, "");
        fs::remove(path("all.exr"));
    }
}

TEST_F(Cli, RenderNamesTheSpheresInTheirOrder) {
    const Answer answer =
        run("render ggx:alpha=.3 lambert:kd=.2 --size 16 --light 30,90,2 --json "
            "--light 120,-45 --dome 0 --exposure -1.5 -o " +
            path("s.exr"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "render"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["spheres"][0]["brdf"], "ggx:alpha=0.3");
    EXPECT_EQ(json["spheres"][1]["column"], 16);
    ASSERT_EQ(json["lights"].size(), 2u);
    EXPECT_NEAR(json["lights"][1]["theta"].get<double>(), 120, 1e-9);
    EXPECT_NEAR(json["lights"][1]["phi"].get<double>(), -45, 1e-9);
    EXPECT_EQ(json["lights"][0]["strength"], 2);
    EXPECT_EQ(json["lights"][1]["strength"], 1);
    EXPECT_EQ(json["exposure"], Json({{"automatic", false}, {"stops", -1.5}}));
}

TEST_F(Cli, RenderNamesCoefficientsByTheirFile) {
    const std::string file = path("c.json"), lobe = "phong:exponent=22", to = " --json -o ";
    ASSERT_EQ(run("project " + lobe + " --order 3 -o " + file).code, 0);
    const Answer spheres = run("render " + file + " " + lobe + " --size 8" + to + path("a.png"));
    ASSERT_EQ(spheres.code, 0) << spheres.err;
    EXPECT_EQ(Json::parse(spheres.out)["spheres"][0]["brdf"], file);
    EXPECT_EQ(Json::parse(spheres.out)["spheres"][1]["brdf"], lobe);
    // Both ways of a file are of its own sum, however poor: a remark says what shows the loss.
    const std::string lit = "render " + file + " --light uniform --size 8 --samples 1" + to;
    const Answer both = run(lit + path("b.png"));
    ASSERT_EQ(both.code, 0) << both.err;
    const Json document = Json::parse(both.out);
    ASSERT_EQ(document["pictures"].size(), 3U);
    for (const Json& picture : document["pictures"]) EXPECT_EQ(picture["brdf"], file);
    EXPECT_NE(both.err.find("render " + lobe + " " + file), std::string::npos) << both.err;
    const std::string one = run(lit + path("c.png") + " --by integration").err;
    EXPECT_EQ(one.find("both pictures"), std::string::npos) << one;
}

TEST_F(Cli, RenderEndsIntegrationInTimeAndSaysSo) {
    const std::string sky = "render ggx:alpha=.1 --light sky:type=12,elevation=30 --size 48 ";
    expectError(sky + "--by coefficients --seconds 1 -o " + path("t.exr"), 2, "--by integration",
                0);
    const Answer answer = run(sky + "--by integration --seconds 0.01 --json -o " + path("s.exr"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_NE(answer.err.find("the time was over before"), std::string::npos) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "render"));
    const Json picture = Json::parse(answer.out)["pictures"][0];
    EXPECT_GT(picture["early_points"], 100);
    EXPECT_LE(picture["largest_error"], 0.5);
}

TEST_F(Cli, RenderRefusesInOneLine) {
    const std::string to = " -o " + path("s.png");
    expectError("render lambert", 2, "--output", 0);
    expectError("render lambert -o " + path("s.jpeg"), 2, ".exr", 0);
    for (const char* light : {"45", "45,", "181,0", "45,0,-1", "45,0,1,2", "45,nan"}) {
        expectError(std::string("render lambert --light ") + light + to, 2, "THETA,PHI", 0);
    }
    expectError("render lambert --light x,0" + to, 2, "x,0", 0);
    expectError("render lambert --exposure bright" + to, 2, "auto", 0);
    expectError("render lambert --size 4" + to, 2, "--size", 0);
    expectError("render lambert --samples 2.5" + to, 2, "--samples: '2.5' is no whole number", 0);
    expectError("render lambert --exposures 0,200" + to, 2, "'200' is not within -100 to 100", 0);
    expectError("render lambert --error 60%" + to, 2, "'0.6' is not within 1e-06 to 0.5", 0);
    expectError("render lambert --view 200,0" + to, 2, "theta from 0 to 180", 0);
    expectError("render lambret" + to, 2, "lambert", 0);
    expectError("render lambert -o " + path("absent/s.png"), 5, "absent", 0);
}

TEST_F(Cli, RenderOfSpheresRefusesTheDetailsOfSurfaces) {
    const std::string job = "render lambert --size 16 -o " + path("s.png");
    for (const std::string option :
         {" --cosine", " --outgoing 8", " --tolerance 10%", " --error 10%", " --up z"})
        expectError(job + option, 2, "is not for spheres in point lights", 0);
    EXPECT_EQ(run(job + " --light uniform --by integration --tolerance 10%").code, 0);
}

TEST_F(Cli, RenderComparesCoefficientsWithIntegration) {
    const std::string job =
        "render lambert:kd=.5 phong:exponent=8,ks=.5 --size 16 --samples 1 --light uniform "
        "--light 40,60,.5 --orders 2,6 --json --force -o " +
        path("s.exr");
    const Answer answer = run(job);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "render"));
    const Json json = Json::parse(answer.out);
    const Json& pictures = json["pictures"];
    // A row for each material: integration, then coefficients and difference of each order.
    ASSERT_EQ(pictures.size(), 10u);
    for (std::size_t k = 0; k < 10; ++k) {
        EXPECT_EQ(pictures[k]["row"], k < 5 ? 0 : 16);
        EXPECT_EQ(pictures[k]["column"], 16 * (k % 5));
    }
    EXPECT_EQ(pictures[0]["by"], "integration");
    EXPECT_EQ(pictures[8]["by"], "coefficients");
    EXPECT_EQ(pictures[9]["by"], "difference");
    EXPECT_EQ(pictures[9]["order"], 6);
    // Lambert is in the span of the first band; a lobe needs more.
    EXPECT_LT(pictures[1]["relative_l2"], 1e-3);
    EXPECT_GT(pictures[6]["relative_l2"], 2 * pictures[8]["relative_l2"].get<double>());
    EXPECT_GE(pictures[6]["maximum"], pictures[6]["relative_l2"]);
    // Uniform light of radiance 1 on albedo 0.5, and the point light.
    EXPECT_GT(pictures[1]["mean_radiance"], 0.5);
}

/// The least order of hsh whose coefficients of f cos(theta_i) miss at most 1 %: a captured energy
/// of 0.9999.
int enoughFor(const Json& report) {
    for (const Json& point : report["reports"][0]["curves"][0]["points"])
        if (point["accuracy"] >= 0.9999) return point["order"];
    return 0;
}

/// A sample of docs/figures/render_within.py.
TEST_F(Cli, RenderIsWithinOnePercentAtTheOrderThatTheReportCallsEnough) {
    for (const char* material : {"oren-nayar:sigma=30", "minnaert:k=1.5", "phong:exponent=22"}) {
        const Answer report = run(std::string("report ") + material +
                                  " --bases hsh --max-order 16 --outgoing 64 --cosine --json");
        ASSERT_EQ(report.code, 0) << report.err;
        const int order = enoughFor(Json::parse(report.out));
        ASSERT_GT(order, 1) << material;
        for (const char* light : {"uniform", "sun:elevation=40,azimuth=20", "panel:elevation=50"}) {
            const Answer answer = run(std::string("render ") + material + " --cosine --order " +
                                      std::to_string(order) + " --light " + light +
                                      " --size 24 --samples 1 --json --force -o " + path("a.exr"));
            ASSERT_EQ(answer.code, 0) << answer.err;
            EXPECT_LT(Json::parse(answer.out)["pictures"][1]["relative_l2"], 0.01)
                << material << " under " << light;
            EXPECT_EQ(answer.err, "") << material << " under " << light;
        }
    }
}

TEST_F(Cli, RenderSaysThatAnOrderWhichIsEnoughMissesThePicture) {
    // Eight outgoing elevations are too few to interpolate a lobe between.
    const Answer answer =
        run("render phong:exponent=22 --cosine --order 14 --outgoing 8 --light sun:elevation=40 "
            "--size 24 --samples 1 --json -o " +
            path("a.exr"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json picture = Json::parse(answer.out)["pictures"][1];
    EXPECT_LT(picture["missed"], 0.01);
    EXPECT_GT(picture["relative_l2"], 0.01);
    EXPECT_NE(answer.err.find("although the coefficients are within"), std::string::npos);
    EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1);
}

/// A series of few bands is below 0 at places, and its radiance cancels to almost nothing at some
/// points. It is smoother than its model and must not take much longer.
TEST_F(Cli, RenderOfCoefficientsTakesAboutAsManyEvaluationsAsOfTheirModel) {
    const std::string file = path("c.json");
    ASSERT_EQ(run("project phong:exponent=22 --order 4 --outgoing 12 -o " + file).code, 0);
    std::vector<double> evaluations;
    for (const std::string& spec : {std::string("phong:exponent=22"), file}) {
        const Answer answer =
            run("render " + spec +
                " --light sky:type=12,elevation=40+sun:elevation=40,irradiance=3 --size 16 "
                "--samples 1 --by integration --tolerance 0.005 --json --force -o " +
                path("c.exr"));
        ASSERT_EQ(answer.code, 0) << answer.err;
        EXPECT_EQ(answer.err.find("cut short"), std::string::npos) << answer.err;
        evaluations.push_back(Json::parse(answer.out)["pictures"][0]["evaluations"]);
    }
    EXPECT_LT(evaluations[1], 2 * evaluations[0]);
}

TEST_F(Cli, RenderByIntegrationStatesTheErrorsOfItsPixels) {
    const std::string job =
        "render ggx:alpha=.3 --light sky:type=12,elevation=40 --by integration --size 16 "
        "--samples 1 --json --force -o " +
        path("s.exr");
    double before = 1;
    for (const char* error : {"10%", "0.005"}) {
        const Answer answer = run(job + " --error " + error);
        ASSERT_EQ(answer.code, 0) << answer.err;
        EXPECT_TRUE(keepsSchema(answer.out, "render"));
        const Json picture = Json::parse(answer.out)["pictures"][0];
        EXPECT_LE(picture["error"], picture["largest_error"]);
        EXPECT_LT(picture["largest_error"], before);
        before = picture["largest_error"];
        // A layer of the file has the errors.
        EXPECT_NE(read(path("s.exr")).find("error.Y"), std::string::npos);
    }
    EXPECT_LE(before, 0.005);
    fs::remove(path("s.exr"));
    expectError("render ggx --light uniform --error 1x -o " + path("t.png"), 2, "--tolerance", 0);
}

TEST_F(Cli, RenderInPerspective) {
    const Answer answer = run(
        "render lambert --light uniform --by integration --size 16 --samples 1 --field-of-view 60 "
        "--json -o " +
        path("s.exr"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "render"));
    EXPECT_EQ(Json::parse(answer.out)["field_of_view"], 60);
    expectError("render lambert --light uniform --field-of-view 180 -o " + path("t.png"), 2,
                "--field-of-view", 1);
}

TEST_F(Cli, RenderLightsMeshes) {
    write("quad.obj", "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\n");
    const Answer answer = run("render lambert --mesh " + path("quad.obj") +
                              " --view 0,0 --light uniform --by integration --size 16 --samples 1 "
                              "--exposures -1,1 --json -o " +
                              path("s.exr"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "render"));
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["mesh"]["triangles"], 2);
    EXPECT_EQ(json["pictures"].size(), 2u);
    EXPECT_EQ(json["pictures"][1]["exposure"], 1);
    // A square from above fills the frame.
    EXPECT_GE(json["points"], 14 * 14);
}

TEST_F(Cli, RenderOfSurfacesRefusesInOneLine) {
    const std::string to = " -o " + path("s.png");
    expectError("render lambert --light moonlight" + to, 2, "moonlight", 0);
    expectError("render lambert --by magic" + to, 2, "--by", 0);
    expectError("render lambert --basis hash --light uniform" + to, 2, "hsh", 0);
    expectError("render lambert --order 0 --light uniform" + to, 2, "order", 0);
    expectError("render lambert --view 75" + to, 2, "THETA,PHI", 0);
    expectError("render lambert --exposures 1,x" + to, 2, "--exposures", 0);
    expectError("render lambert --mesh " + path("absent.obj") + to, 3, "absent.obj", 0);
    write("empty.obj", "# nothing\n");
    expectError("render lambert --mesh " + path("empty.obj") + to, 3, "no faces", 1);
    EXPECT_FALSE(fs::exists(path("s.png")));
}

TEST_F(Cli, RenderGivesTheSameBytesWhateverTheThreads) {
    const std::string job = "render ward:ax=.1,ay=.4 ggx:alpha=.2 --size 48 ";
    for (const char* extension : {".png", ".exr"}) {
        ASSERT_EQ(run(job + "--threads 1 -o " + path("a") + extension).code, 0);
        ASSERT_EQ(run(job + "--threads 3 -o " + path("b") + extension).code, 0);
        EXPECT_FALSE(read(path("a") + extension).empty());
        EXPECT_TRUE(read(path("a") + extension) == read(path("b") + extension)) << extension;
    }
}

TEST_F(Cli, CompareWritesAPage) {
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    const Answer answer =
        run("compare ggx:alpha=.4 phong:exponent=9 --outgoing 4 --json --force -o " + path("page"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "compare"));
    EXPECT_TRUE(keepsSchema(read(path("page/comparison.json")), "comparison"));
    const Json printed = Json::parse(answer.out);
    EXPECT_EQ(printed["metrics"], Json::parse(read(path("page/comparison.json")))["metrics"]);
    EXPECT_EQ(printed["picture"], Json::parse(read(path("page/comparison.json")))["picture"]);
    EXPECT_NE(read(path("page/comparison.html")).find("highest false peak"), std::string::npos);
    for (const auto& file : printed["report"]["files"]) {
        EXPECT_TRUE(fs::exists(path("page/") + file.get<std::string>())) << file;
    }
    // The page has every metric, whichever were asked for on the command line.
    ASSERT_EQ(run("compare ggx:alpha=.4 phong:exponent=9 --outgoing 4 --metrics log --force -o " +
                  path("page"))
                  .code,
              0);
    EXPECT_EQ(printed["metrics"], Json::parse(read(path("page/comparison.json")))["metrics"]);
}

TEST_F(Cli, CompareNamesAPresetAsItIsGivenAndStatesAReasonOnce) {
    // Its square has no integral, so that relative-l2 and captured-energy have the same reason.
    write("long.json",
          R"({"format": "hshfit-preset", "version": 1, "model": "ward", "parameters": )"
          R"({"kd": 0.0512345678901234, "ks": 0.312345678901234, "ax": 0.212345678901234, )"
          R"("ay": 0.112345678901234}})");
    const std::string own = run("info " + path("long.json")).out;
    ASSERT_NE(own.find("ward:kd=0.0512345678901234,"), std::string::npos) << own;
    const Answer answer = run("compare ggx:alpha=.3 " + path("long.json") + " --outgoing 4");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(answer.out.find("ward:"), std::string::npos) << answer.out;
    const std::string reason = path("long.json") + " grows like";
    const std::size_t first = answer.out.find(reason);
    ASSERT_NE(first, std::string::npos) << answer.out;
    EXPECT_EQ(answer.out.find(reason, first + 1), std::string::npos) << answer.out;
    EXPECT_NE(answer.out.find("(as relative-l2)"), std::string::npos) << answer.out;
}

TEST_F(Cli, CompareBlamesTheModelAndNotItsCoefficientsOfTheSameName) {
    // f grows like cos^-1/2 towards the horizon; coefficients are bounded.
    const std::string model = "ward:ax=0.25,ay=0.25";
    ASSERT_EQ(run("project " + model + " --order 4 --outgoing 4 -o " + path("w.json")).code, 0);
    const Answer answer = run("compare " + model + " " + path("w.json") + " --metrics relative-l2");
    EXPECT_NE(answer.out.find("(" + model + " grows like"), std::string::npos) << answer.out;
}

TEST_F(Cli, CompareFailsBeforeItWrites) {
    write("file", "x");
    const std::string job = "compare lambert lambert:kd=.5 --outgoing 2 -o ";
    expectError(job + path("file"), 5, "cannot make the folder", 1);
    expectError(job + path("absent/page"), 5, "cannot make the folder", 1);
}

}  // namespace
