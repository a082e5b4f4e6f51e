// `hshfit fit` from the command line.

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <map>
#include <set>
#include <string>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;
namespace fs = std::filesystem;

TEST_F(Cli, FitIsAPresetThatOpens) {
    const Answer answer =
        run("fit ward:kd=.1,ks=.3,ax=.2,ay=.2 --model ward --json -o " + path("fit.json"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "fit"));
    const std::string at = " --wi 30,10 --wo 40,170";
    EXPECT_NEAR(std::stod(run("eval " + path("fit.json") + at).out.substr(5)),
                std::stod(run("eval ward:kd=.1,ks=.3,ax=.2,ay=.2" + at).out.substr(5)), 1e-4);
}

// Numbers, colours and words of several terms, as they were stated.
TEST_F(Cli, FitNamesTheParametersThatItHolds) {
    const std::string call =
        "fit ggx:alpha=.3 --samples 200 --starts 2 --accept --model "
        "'lambert+ggx:masking=separable,F0=.04'";
    const Answer answer = run(call + " --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "fit"));
    const Json fit = Json::parse(answer.out)["fit"];
    std::map<std::string, Json> held;
    for (const Json& own : fit["held"]) held[own["name"]] = own["value"];
    EXPECT_EQ(held["ggx.masking"], "separable");
    EXPECT_EQ(held["ggx.F0"], 0.04);
    // No parameter is both fitted and held.
    for (const Json& own : fit["parameters"]) EXPECT_FALSE(held.contains(own["name"])) << own;
    const std::string text = run(call).out;
    EXPECT_NE(text.find("ggx.F0 = 0.04"), std::string::npos) << text;
    EXPECT_NE(text.find("ggx.masking = separable"), std::string::npos) << text;
    const std::string metal =
        run("fit ggx:alpha=.2,metal=gold,nm=550/650 --model ggx:metal=gold,kd=0").out;
    EXPECT_NE(metal.find("held: metal = gold, kd = 0\n"), std::string::npos) << metal;
    // base_diffuse_roughness is at its default, and only coat_roughness is stated.
    const std::string coat =
        run("fit openpbr:coat_weight=.5,coat_roughness=.3 --samples 60 --starts 1 --model "
            "openpbr:coat_roughness=.1,fuzz_weight=0,base_metalness=0,specular_weight=1")
            .out;
    EXPECT_NE(coat.find("coat_roughness = 0.1"), std::string::npos) << coat;
    EXPECT_EQ(coat.find("base_diffuse_roughness"), std::string::npos) << coat;
    const std::string free = run("fit lambert:kd=.3 --model lambert").out;
    EXPECT_EQ(free.find("held: "), std::string::npos) << free;
}

// phong1 and phong2 stand for one lobe: their sets are named once. A roughness that the data do
// not show is in its own line alone.
TEST_F(Cli, FitNamesTogetherWhatTheDataDoNotTellApart) {
    const std::string call =
        "fit phong:ks=.5,exponent=20 --model phong+phong --samples 300 --starts 4";
    const Answer answer = run(call + " --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json document = Json::parse(answer.out);
    std::set<Json> sets;
    for (const Json& own : document["fit"]["ambiguous"])
        EXPECT_TRUE(sets.insert(own).second) << "twice: " << own;
    EXPECT_FALSE(sets.empty());
    EXPECT_NE(run(call).out.find("ambiguous together: phong1."), std::string::npos);
    const std::string alone =
        run("fit lambert:kd=.3 --model lambert+ggx --samples 300 --starts 4").out;
    EXPECT_NE(alone.find("not determined by the data"), std::string::npos) << alone;
    EXPECT_EQ(alone.find("ambiguous together"), std::string::npos) << alone;
}

// A start of many fails, and the others do not.
TEST_F(Cli, FitSpeaksNoWordsOfItsSolver) {
    const Answer answer = run("fit sgd:alpha=.05/.1/.2,p=.5,F0=.4,kd=.1 --model sgd");
    EXPECT_EQ(answer.code, 0);
    for (const char* word : {"Ceres", "Terminating", "Jacobian"})
        EXPECT_EQ(answer.err.find(word), std::string::npos) << answer.err;
}

TEST_F(Cli, FitWritesAReportIntoAFolder) {
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    const Answer answer = run("fit phong:ks=.5,exponent=12 --model phong -o " + path("report"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    for (const char* name : {"report/fit.json", "report/comparison.html", "report/spheres.png"})
        EXPECT_TRUE(fs::exists(path(name))) << name;
    EXPECT_EQ(run("info " + path("report/fit.json")).code, 0);
}

TEST_F(Cli, FitOfAFolderGoesOnAfterAFailure) {
    fs::create_directory(path("data"));
    write("data/broken.binary", "no table");
    write("data/samples.json",
          R"({"format":"hshfit-preset","version":1,"model":"phong","parameters":{"exponent":9}})");
    const Answer answer = run("fit --all " + path("data") + " --model phong -o " + path("out"));
    EXPECT_NE(answer.code, 0);
    EXPECT_NE(answer.out.find("broken.binary"), std::string::npos) << answer.out;
    EXPECT_EQ(std::distance(fs::directory_iterator(path("out")), {}), 1) << answer.out;
    const Answer again = run("fit --all " + path("data") + " --model phong -o " + path("out"));
    EXPECT_NE(again.out.find("0 fitted, 1 kept"), std::string::npos) << again.out;
}

// A measured aluminium, over five decades (data/field/measured/07): the peak alone decides least
// squares of f, and that is called poor.
TEST_F(Cli, FitsOfSamplesOverDecadesSeeAllOfThem) {
    const std::string data = hshfit::test::sharedFolder() +
                             "/data/field/measured/07-fit-loss-scattered/abg.astm:angles=degrees";
    const std::string job = "fit " + data + " --model lambert+ggx --json";
    const Answer answer = run(job);
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "fit"));
    const Json fit = Json::parse(answer.out)["fit"];
    EXPECT_EQ(fit["loss"], "log-relative");
    EXPECT_LT(fit["factors"]["median"], 2);
    const Json poor = Json::parse(run(job + " --loss cosine").out);
    EXPECT_GT(poor["fit"]["factors"]["median"], 10);
    ASSERT_TRUE(poor.contains("poor"));
    EXPECT_NE(poor["poor"]["better"].get<std::string>().find("--loss log-relative"),
              std::string::npos)
        << poor["poor"];
}

// The tint of disney is baseColor over its luminance, so that a channel depends on all colours.
TEST_F(Cli, FitsOfColoursAreColouredOrSayWhichAlbedoIsOneNumber) {
    const Answer own = run("fit eon:kd=.5/.3/.1,roughness=.6 --model eon --json");
    ASSERT_EQ(own.code, 0) << own.err;
    EXPECT_FALSE(Json::parse(own.out).contains("poor")) << own.out;
    const Answer tinted =
        run("fit disney:baseColor=.5/.3/.1,specularTint=.5,clearcoat=0 --model "
            "disney:specularTint=.5,metallic=0,clearcoat=0,sheen=0,subsurface=0 --accept --json");
    ASSERT_EQ(tinted.code, 0) << tinted.err;
    EXPECT_TRUE(Json::parse(tinted.out)["poor"]["reason"].get<std::string>().starts_with(
        "baseColor is one number for all channels: "))
        << tinted.out;
}

TEST_F(Cli, FitEndsInTimeWithWhatItHas) {
    const std::string job = "fit ggx:alpha=.3,kd=.2 --model disney --seconds 0.01 ";
    expectError(job + "-o " + path("x.json"), 4, "stopped at the end of the time", 0);
    EXPECT_FALSE(fs::exists(path("x.json")));
    const Answer taken = run(job + "--accept --json");
    ASSERT_EQ(taken.code, 0) << taken.err;
    EXPECT_EQ(Json::parse(taken.out)["fit"]["converged"], false);
}

TEST_F(Cli, FitNamesWhatIsWrong) {
    expectError("fit lambert -o " + path("x.json"), 2, "--model", 0);
    expectError("fit --model ward -o " + path("x.json"), 2, "DATA", 0);
    expectError("fit lambert --model wrad -o " + path("x.json"), 2, "ward", 0);
    expectError("fit lambert --model ward --loss l3 -o " + path("x.json"), 2, "cube-root", 0);
    expectError("fit " + path("absent.binary") + " --model ward -o " + path("x.json"), 3,
                "absent.binary", 0);
    expectError("fit lambert --model lambert --residuals " + path("one.csv") + " -o " +
                    path("../") + folder_.filename().string() + "/one.csv",
                2, "both write", 0);
}

}  // namespace
