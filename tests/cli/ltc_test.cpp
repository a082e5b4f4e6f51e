// ltc and gaussians from the command line.

#include <cli/program.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

TEST_F(Cli, LtcWritesEveryForm) {
    const Answer answer = run("ltc ggx --size 4 --json --force -o " + path("t.dds") +
                              " --force -o " + path("t.exr") + " --force -o " + path("t.json"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json json = Json::parse(answer.out);
    EXPECT_EQ(json["size"], 4);
    ASSERT_EQ(json["outputs"].size(), 5u);
    for (const Json& output : json["outputs"]) {
        EXPECT_GT(fs::file_size(output.get<std::string>()), 0u);
    }
    EXPECT_TRUE(keepsSchema(read(path("t.json")), "ltc"));
    EXPECT_TRUE(keepsSchema(answer.out, "ltc_answer"));
    const Json table = Json::parse(read(path("t.json")));
    EXPECT_EQ(table["summary"]["mean_error"], json["mean_error"]);
    EXPECT_EQ(table["values"][3], 1);
}

TEST_F(Cli, LtcStatesTheLargestShareBesideTheMean) {
    const Answer answer = run("ltc ggx --size 3 -o " + path("t.json"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json table = Json::parse(read(path("t.json")));
    double largest = 0;
    for (const Json& row : table["misplaced"])
        for (const double share : row) largest = std::max(largest, share);
    const std::string words = "% of the light misplaced, at most ";
    const std::size_t at = answer.out.find(words);
    ASSERT_NE(at, std::string::npos) << answer.out;
    EXPECT_NEAR(std::stod(answer.out.substr(at + words.size())), 100 * largest, 0.05001);
}

TEST_F(Cli, LtcNamesWhatIsWrong) {
    expectError("ltc ggx -o " + path("t.png"), 2, ".json, .exr or .dds", 0);
    expectError("ltc ggx:alpha=.2 -o " + path("t.json"), 2, "runs over roughness", 0);
    expectError("ltc phong -o " + path("t.json"), 2, "exponent", 0);
    expectError("ltc ggx --size 1 -o " + path("t.json"), 2, "size", 0);
    expectError("ltc ggx --mapping cube -o " + path("t.json"), 2, "mapping", 0);
    expectError("ltc lambert --parameter kd --size 2 -o " + path("t.json"), 4, "is 0", 0);
    expectError("ltc ggx --size 2 -o " + path("no/t.json"), 5, "no/t.json", 0);
}

TEST_F(Cli, GaussiansAreABrdf) {
    const Answer answer =
        run("gaussians ggx:alpha=.3 --lobes 2 --kind asg --outgoing 3 --json "
            "--metrics relative-l2-cosine -o " +
            path("g.json"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json json = Json::parse(answer.out);
    EXPECT_TRUE(keepsSchema(read(path("g.json")), "gaussians"));
    EXPECT_TRUE(keepsSchema(answer.out, "gaussians_answer"));
    // The command that compares BRDFs finds the same error from the file.
    const Answer compared = run("compare ggx:alpha=.3 " + path("g.json") +
                                " --outgoing 3 --metrics relative-l2-cosine --json");
    ASSERT_EQ(compared.code, 0) << compared.err;
    EXPECT_NEAR(Json::parse(compared.out)["metrics"][0]["value"].get<double>(),
                json["metrics"][0]["value"].get<double>(), 1e-9);
    EXPECT_EQ(run("info " + path("g.json")).code, 0);
}

// By the rule of all other commands, and with the numbers of `compare`.
TEST_F(Cli, GaussiansThatLookWrongArePoor) {
    const std::string call = "gaussians ggx:alpha=.3 --loss cosine --force -o " + path("g.json");
    const Answer answer = run(call + " --json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json json = Json::parse(answer.out);
    const Answer compared = run("compare ggx:alpha=.3 " + path("g.json") + " --json");
    ASSERT_EQ(compared.code, 0) << compared.err;
    const Json own = json["picture"], theirs = Json::parse(compared.out)["picture"];
    for (const char* key : {"flip", "ciede2000"})
        EXPECT_NEAR(own[key]["mean"], theirs[key]["mean"].get<double>(), 1e-6) << key;
    EXPECT_NEAR(own["false_peak"]["value"], theirs["false_peak"]["value"].get<double>(), 1e-6);
    ASSERT_GT(own["false_peak"]["value"], 0.1);
    EXPECT_NE(json["poor"]["reason"].get<std::string>().find("a false peak of"), std::string::npos);
    const Answer text = run(call);
    EXPECT_NE(text.err.find("poor: a false peak of"), std::string::npos) << text.err;
    EXPECT_NE(text.out.find("FLIP "), std::string::npos) << text.out;
    // The call to try has no such peak.
    std::string call2 = json["poor"]["to_try"];
    ASSERT_TRUE(call2.starts_with("hshfit project ggx:alpha=0.3 -o coefficients.json")) << call2;
    call2.replace(call2.find("coefficients.json"), 17, path("c.json"));
    const Answer better = run(call2.substr(7) + " --json");
    ASSERT_EQ(better.code, 0) << better.err;
    EXPECT_FALSE(Json::parse(better.out).contains("poor"));
    // The usual loss is near the look of a picture, and keeps more of the light.
    for (const std::string kind : {"sg", "asg"}) {
        const auto answerOf = [&](const std::string& loss) {
            return Json::parse(run("gaussians ggx:alpha=.3 --quiet --json --force --kind " + kind +
                                   loss + " -o " + path("g.json"))
                                   .out);
        };
        const Json usual = answerOf(""), cosine = answerOf(" --loss cosine");
        EXPECT_LT(usual["picture"]["flip"]["mean"],
                  0.9 * cosine["picture"]["flip"]["mean"].get<double>());
        EXPECT_LT(usual["largest_energy_error"],
                  0.9 * cosine["largest_energy_error"].get<double>());
    }
    // Smooth lobes look right; one direction has no picture.
    EXPECT_EQ(run("gaussians lambert --quiet --json -o " + path("l.json")).out.find("\"poor\""),
              std::string::npos);
    EXPECT_EQ(run("gaussians ggx:alpha=.3 --outgoing 30,0 --json -o " + path("d.json"))
                  .out.find("\"picture\""),
              std::string::npos);
}

TEST_F(Cli, GaussiansNameWhatIsWrong) {
    expectError("gaussians ward:ax=.1,ay=.3 -o " + path("g.json"), 2, "isotropic", 0);
    expectError("gaussians ggx:alpha=.3 --outgoing 4x4 -o " + path("g.json"), 2, "elevations", 0);
    expectError("gaussians ggx:alpha=.3 --kind gs -o " + path("g.json"), 2, "kind", 0);
    expectError("gaussians lambert:kd=0 -o " + path("g.json"), 4, "is 0", 0);
}

}  // namespace
}  // namespace hshfit::test
