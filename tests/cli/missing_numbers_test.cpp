// Numbers that do not exist: one rule for shares of a function that is 0, one line on standard
// error for each exit code that is not 0, and figures of errors that are 0.

#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cstring>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

/// A number that is not one, as printf and fmt write it.
bool hasNan(const std::string& text) {
    for (const char* word : {" nan", "-nan", "nan%", "\tnan", "inf +-"})
        if (text.find(word) != std::string::npos) return true;
    return false;
}

class MissingNumbers : public Cli {
protected:
    /// 150 samples of one value, in ALTA's format.
    std::string samplesOf(double value) const {
        std::string text =
            "#ALTA HEADER BEGIN\n#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n"
            "#PARAM_OUT INV_STERADIAN\n#FORMAT text\n#ALTA HEADER END\n";
        for (int i = 0; i < 5; ++i)
            for (int o = 0; o < 5; ++o)
                for (int k = 0; k < 6; ++k)
                    text += std::to_string(0.35 * i) + " 0 " + std::to_string(0.35 * o) + " " +
                            std::to_string(k) + " " + std::to_string(value) + "\n";
        write("samples.alta", text);
        return path("samples.alta");
    }
};

TEST_F(MissingNumbers, NoShareOfAFunctionThatIsZeroIsCaptured) {
    const std::string file = path("z.json"), zero = "lambert:kd=0";
    for (const char* form : {"", " --form basis", " --form outgoing --precision half"}) {
        const std::string call = "project " + zero + " -o " + file + form + " --force";
        const Answer text = run(call);
        EXPECT_EQ(text.code, 0) << text.err;
        EXPECT_NE(text.out.find("no captured energy"), std::string::npos) << text.out;
        const Json json = Json::parse(run(call + " --json").out);
        EXPECT_TRUE(json["accuracy"].is_null()) << form;
        EXPECT_EQ(json["energy"]["value"], 0);
    }
    const Answer light = run("light uniform:radiance=0 -o " + path("l.json"));
    EXPECT_EQ(light.code, 0) << light.err;
    EXPECT_NE(light.out.find("no captured energy"), std::string::npos) << light.out;
    // Nothing but shares was asked for.
    const Answer report = run("report " + zero);
    EXPECT_EQ(report.code, 4);
    EXPECT_NE(report.out.find("no captured energy"), std::string::npos) << report.out;
    EXPECT_NE(report.err.find("no captured energy"), std::string::npos) << report.err;
    const Answer compare = run("compare " + zero + " " + file + " --metrics captured-energy");
    EXPECT_EQ(compare.code, 4);
    EXPECT_NE(compare.err.find("captured-energy: the reference is zero"), std::string::npos);
    for (const Answer& answer :
         {report, compare, run("compare " + zero + " " + file),
          run("compare " + zero + " lambert:kd=0.1"), run("stress " + zero + " --max-order 4")})
        EXPECT_FALSE(hasNan(answer.out)) << answer.out;
}

TEST_F(MissingNumbers, EachExitCodeHasALineOnStandardError) {
    const std::string data = "lambert:kd=.3+ggx:alpha=.3,F0=.5";
    std::filesystem::create_directory(path("data"));
    write("data/broken.binary", "no table");
    for (const std::string& call :
         {"fit '" + data + "' --compare-models lambert+ggx --iterations 1 --starts 1",
          "fit --all " + path("data") + " --model phong -o " + path("fits"),
          std::string("report ward:ax=.2,ay=.5 --max-order 3"),
          std::string("report lambert:kd=0 --max-order 3"),
          std::string("compare lambert:kd=0 lambert:kd=.1 --metrics relative-l2")}) {
        for (const char* more : {"", " --quiet", " --json"}) {
            const Answer answer = run(call + more);
            EXPECT_EQ(answer.code, 4) << call << more << answer.err;
            EXPECT_TRUE(answer.err.starts_with("hshfit: ")) << call << more;
        }
    }
    const Answer refused =
        run("fit '" + data + "' --compare-models lambert+ggx --iterations 1 --starts 1");
    EXPECT_NE(refused.err.find("did not converge"), std::string::npos) << refused.err;
}

TEST_F(MissingNumbers, ErrorsOfZeroHaveFigures) {
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    for (const char* brdf : {"lambert:kd=0", "lambert:kd=0.5"}) {
        const Answer answer =
            run(std::string("tradeoff ") + brdf + " --force -o " + path("trade") +
                " --bases zernike --orders 3 --outgoing 4 --halfway 6,3,1 --ranks 0 --split none "
                "--precisions float32 --pair-count 2048");
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_FALSE(hasNan(answer.out)) << answer.out;
        for (const char* name : {"front.svg", "timing.svg", "tradeoff.html"})
            EXPECT_NE(read(path(std::string("trade/") + name)).find("</svg>"), std::string::npos);
    }
}

TEST_F(MissingNumbers, EvalEndsWhereFIsNotFinite) {
    ASSERT_EQ(run("project phong:exponent=5 -o " + path("p.json")).code, 0);
    Json json = Json::parse(read(path("p.json")));
    // Their sum with positive functions overflows.
    const auto fill = [](auto& self, Json& node) -> void {
        if (node.is_number()) node = 1.7e308;
        for (std::size_t k = 0; node.is_array() && k < node.size(); ++k) self(self, node[k]);
    };
    fill(fill, json["coefficients"]);
    write("huge.json", json.dump());
    write("pairs.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0.5,0,0.8660254,0.1,0,0.9949874\n");
    for (const std::string& where : {std::string(" --wi 30,0 --wo 5.739170,0"),
                                     " --pairs " + path("pairs.csv") + " -o " + path("out.csv")})
        expectError("eval " + path("huge.json") + where, 4, "not finite at wi = 30,0", 3);
}

TEST_F(MissingNumbers, SamplesBelowZeroAloneAreSaid) {
    const std::string file = samplesOf(-0.1);
    write("pairs.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,0.6,0,0.8\n");
    for (const std::string& call : {"eval " + file + " --wi 30,180 --wo 20,0",
                                    "eval " + file + " --pairs " + path("pairs.csv"),
                                    "project " + file + " -o " + path("n.json")}) {
        const Answer answer = run(call);
        EXPECT_EQ(answer.code, 0) << answer.err;
        EXPECT_NE(answer.err.find("of 150 values none is above 0, and 150 are below"),
                  std::string::npos)
            << call << answer.err;
    }
    EXPECT_NE(run("info " + file).out.find("none is above 0"), std::string::npos);
    EXPECT_EQ(run("eval " + samplesOf(0.1) + " --wi 30,180 --wo 20,0").err, "");
}

}  // namespace
