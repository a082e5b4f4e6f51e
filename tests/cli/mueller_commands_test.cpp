// Elements of Mueller matrices as channels by name, as a user of the commands meets them: values,
// coefficients that are written and read back, and refusals in one line.

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

class MuellerCommands : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        // SCATMECH rows i, j, n, m, k, l, p, a, at no wavelength.
        write("t.csv",
              "1,1,0,0,0,0,0,0.6\n1,1,2,0,0,0,0,-0.1\n1,2,2,2,0,0,0,0.1\n1,2,0,0,0,0,0,-0.3\n"
              "2,2,0,0,0,0,0,0.5\n");
        table_ = path("t.csv");
    }
    Json json(const std::string& arguments) const {
        const Answer answer = run(arguments + " --json");
        EXPECT_EQ(answer.code, 0) << arguments << "\n" << answer.err;
        return Json::parse(answer.out, nullptr, false);
    }
    std::string table_;
};

TEST_F(MuellerCommands, EvalHasAColumnForEachElement) {
    const std::string at = " --wi 30,0 --wo 60,120";
    const Json all = json("eval " + table_ + ":mueller=m11/m00/m01" + at);
    EXPECT_EQ(all["channels"], Json({"m00", "m01", "m11"}));
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string name = all["channels"][c];
        const double single = json("eval " + table_ + ":mueller=" + name + at)["values"][0];
        EXPECT_NEAR(all["values"][c].get<double>(), single, 1e-15) << name;
        EXPECT_NE(single, 0) << name;
    }
    write("pairs.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,0,0,1\n");
    const Answer pairs = run("eval " + table_ + ":mueller=m00/m01 --pairs " + path("pairs.csv"));
    EXPECT_EQ(pairs.out.substr(0, pairs.out.find('\n')), "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,m00,m01");
}

TEST_F(MuellerCommands, LawsAreThoseOfTheReflectanceAlone) {
    const Answer answer = run("info " + table_ + ":mueller=m00/m01 --json");
    EXPECT_TRUE(keepsSchema(answer.out, "info")) << answer.err;
    const Json both = Json::parse(answer.out), alone = json("info " + table_);
    EXPECT_EQ(both["channels"], Json({"m00", "m01"}));
    EXPECT_FALSE(both["laws"]["non_negative"].get<bool>());
    EXPECT_LT(both["range"]["min"].get<double>(), 0);
    EXPECT_EQ(both["health"]["negative"], 0);
    EXPECT_TRUE(both["health"]["suggested_repairs"].empty());
    ASSERT_EQ(both["albedo"][2]["values"].size(), 1u);
    EXPECT_NEAR(both["albedo"][2]["values"][0].get<double>(),
                alone["albedo"][2]["values"][0].get<double>(), 1e-6);
    const Answer other = run("info " + table_ + ":mueller=m01 --json");
    EXPECT_TRUE(keepsSchema(other.out, "info")) << other.err;
    EXPECT_FALSE(Json::parse(other.out).contains("health"));
    EXPECT_EQ(run("info " + table_ + ":mueller=m01").out.find("albedo"), std::string::npos);
}

TEST_F(MuellerCommands, CoefficientsAreWrittenAndReadBack) {
    const std::string how = " --outgoing 4 --order 8 -o ";
    const Json answer = json("project " + table_ + ":mueller=m00/m01" + how + path("two.json"));
    EXPECT_FALSE(answer.contains("picture"));
    json("project " + table_ + ":mueller=m01" + how + path("one.json"));
    json("project " + table_ + ":mueller=m00/m01" + how + path("two.exr"));
    const std::string text = read(path("two.json"));
    EXPECT_TRUE(keepsSchema(text, "coefficients"));
    const Json two = Json::parse(text), one = Json::parse(read(path("one.json")));
    EXPECT_EQ(two["channel_kind"], "named");
    EXPECT_EQ(two["channels"], Json({"m00", "m01"}));
    for (std::size_t o = 0; o < 4; ++o)
        for (std::size_t slot = 0; slot < 64; ++slot)
            EXPECT_NEAR(two["coefficients"][o][1][slot].get<double>(),
                        one["coefficients"][o][0][slot].get<double>(), 1e-6);
    const std::string at = " --wi 30,0 --wo 60,120";
    const Json written = json("eval " + path("two.json") + at),
               single = json("eval " + path("one.json") + at),
               picture = json("eval " + path("two.exr") + at);
    EXPECT_EQ(picture["channels"], Json({"m00", "m01"}));
    EXPECT_LT(single["values"][0].get<double>(), 0);
    EXPECT_NEAR(written["values"][1].get<double>(), single["values"][0].get<double>(), 1e-6);
    for (std::size_t c = 0; c < 2; ++c)
        EXPECT_NEAR(picture["values"][c].get<double>(), written["values"][c].get<double>(), 1e-6);
    EXPECT_FALSE(json("info " + path("one.json")).contains("health"));
}

TEST_F(MuellerCommands, CompareAndReportTakeThem) {
    const std::string both = table_ + ":mueller=m00/m01", how = " --outgoing 4";
    json("project " + both + how + " --order 8 -o " + path("two.json"));
    const Answer compared = run("compare " + both + " " + path("two.json") + " --json");
    ASSERT_EQ(compared.code, 0) << compared.err;
    EXPECT_TRUE(keepsSchema(compared.out, "compare"));
    EXPECT_FALSE(Json::parse(compared.out).contains("picture"));
    EXPECT_NE(run("compare " + both + " " + path("two.json")).out.find("m01 is no reflectance"),
              std::string::npos);
    const Json same = json("compare " + both + " " + both + how);
    for (const Json& metric : same["metrics"]) {
        if (metric["name"] != "relative_l2") continue;
        EXPECT_EQ(metric["value"], 0);
    }
    EXPECT_EQ(json("report " + both + how + " --bases hsh --max-order 4")["reports"].size(), 1u);
}

TEST_F(MuellerCommands, OthersRefuseInOneLine) {
    const std::string both = table_ + ":mueller=m00/m01";
    json("project " + both + " --outgoing 4 --order 4 -o " + path("two.json"));
    const std::string out = " -o " + path("x.json");
    for (const std::string& command :
         {"fit " + both + " --model ggx" + out, "choose " + both + out, "tradeoff " + both + out,
          "gaussians " + both + out, "sample " + both + " --count 4",
          "render " + both + " --size 16 -o " + path("x.png"),
          "convert " + both + " " + path("x.binary"), "export " + path("two.json") + out,
          "fit " + path("two.json") + " --model ggx" + out,
          "project " + both + " --form basis" + out})
        expectError(command, 3, "m01 is no reflectance", 2);
    expectError("compare " + both + " " + path("two.json") + " -o " + path("page"), 3,
                "m01 is no reflectance", 2);
    expectError("compare " + both + " lambert", 2, "they cannot be compared", 2);
    expectError("info 'lambert + " + both + "'", 2, "the same channels", 2);
    expectError("eval grey:" + both + " --wi 0,0 --wo 0,0", 2, "m01 is no reflectance", 2);
    expectError("eval " + table_ + ":mueller=m44 --wi 0,0 --wo 0,0", 2, "'m44' is unknown", 2);
    expectError("eval " + table_ + ":mueller=m22 --wi 0,0 --wo 0,0", 3, "no row of m22", 2);
}

}  // namespace
