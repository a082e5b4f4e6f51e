// `hshfit fit` as a user meets it.
#include <cli/program.h>

#include <nlohmann/json.hpp>

#include <cctype>
#include <cmath>
#include <set>
#include <string>

namespace {

using hshfit::test::Answer;
using hshfit::test::Cli;
using Json = nlohmann::json;

namespace fs = std::filesystem;

const std::string data = "lambert:kd=.1/.2/.3 + ward:ks=.2,ax=.15,ay=.15";

class Fit : public Cli {};

TEST_F(Fit, ResultIsAPresetThatEveryCommandOpens) {
    const Answer answer =
        run("fit '" + data + "' --model lambert+ward --samples 3000 -o " + path("fit.json"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json preset = Json::parse(read(path("fit.json")));
    EXPECT_EQ(preset["format"], "hshfit-preset");
    for (const Json& parameter : preset["fit"]["parameters"])
        if (parameter["name"] == "ward.ax") {
            EXPECT_NEAR(parameter["value"], 0.15, 1e-6);
        }
    const std::string at = " --wi 30,0 --wo 35,170";
    const Answer fitted = run("eval " + path("fit.json") + at),
                 truth = run("eval '" + data + "'" + at);
    ASSERT_EQ(fitted.code, 0) << fitted.err;
    EXPECT_NEAR(std::stod(fitted.out.substr(2)), std::stod(truth.out.substr(2)), 1e-6);
    EXPECT_EQ(run("info " + path("fit.json")).code, 0);
    EXPECT_TRUE(keepsSchema(read(path("fit.json")), "fit"));
    EXPECT_TRUE(keepsSchema(read(path("fit.json")), "preset"));
}

TEST_F(Fit, ThreadsDoNotChangeABit) {
    for (const char* threads : {"1", "3"})
        ASSERT_EQ(
            run("fit '" + data + "' --model lambert+ggx --loss log --samples 5000 --threads " +
                threads + " -o " + path(threads))
                .code,
            0);
    EXPECT_EQ(read(path("1")), read(path("3")));
}

TEST_F(Fit, UnconvergedFitsAreNoResultUnlessAccepted) {
    const std::string line = "fit '" + data +
                             "' --model abc:variant=microfacet --samples 800 --starts 1 "
                             "--iterations 1 -o " +
                             path("fit.json");
    const Answer refused = run(line);
    EXPECT_EQ(refused.code, 4);
    EXPECT_NE(refused.err.find("--accept"), std::string::npos) << refused.err;
    EXPECT_FALSE(fs::exists(path("fit.json")));
    ASSERT_EQ(run(line + " --accept").code, 0);
    EXPECT_EQ(Json::parse(read(path("fit.json")))["fit"]["converged"], false);
}

TEST_F(Fit, FoldersAreResumedAndFailuresListed) {
    fs::create_directory(path("in"));
    std::ofstream(path("in/good.alta")) << "#DIM 1 1\n#PARAM_IN COS_TH\n#PARAM_OUT INV_STERADIAN\n"
                                           "1 .5\n.9 .4\n.8 .3\n.7 .25\n.6 .22\n.5 .2\n";
    std::ofstream(path("in/bad.binary")) << "no table";
    const std::string line =
        "fit --json --all " + path("in") + " --model blinn-phong --loss l2 -o " + path("out");
    const Answer first = run(line);
    EXPECT_EQ(first.code, 4);
    const Json one = Json::parse(first.out);
    EXPECT_EQ(one["fitted"], 1) << first.out;
    ASSERT_EQ(one["failures"].size(), 1u);
    EXPECT_EQ(one["failures"][0]["file"], path("in/bad.binary"));
    EXPECT_TRUE(fs::exists(path("out/good.alta.json")));
    EXPECT_FALSE(fs::exists(path("out/bad.binary.json")));
    const Json two = Json::parse(run(line).out);
    EXPECT_EQ(two["fitted"], 0);
    EXPECT_EQ(two["kept"], 1);
}

TEST_F(Fit, TheModelThatMadeTheDataRanksFirst) {
    const Answer answer = run("fit --json '" + data +
                              "' --samples 1500 --compare-models lambert+ggx lambert+ward ward "
                              "lambert nonsense");
    EXPECT_EQ(answer.code, 2);
    const Answer ranked = run("fit --json '" + data +
                              "' --samples 1500 --starts 4 --compare-models lambert+ggx "
                              "lambert+sg lambert+ward lambert");
    ASSERT_EQ(ranked.code, 0) << ranked.err;
    const Json models = Json::parse(ranked.out)["models"];
    ASSERT_EQ(models.size(), 4u);
    EXPECT_EQ(models[0]["model"], "lambert+ward");
    EXPECT_EQ(models[3]["model"], "lambert");
    for (const char* criterion : {"aic", "bic"})
        EXPECT_LT(models[0][criterion], models[1][criterion]);
}

TEST_F(Fit, ErrorsAreOneLine) {
    expectError("fit lambert --model lambret", 2, "lambert", 0);
    expectError("fit lambert", 2, "--model", 0);
    expectError("fit lambert --model ward --loss l3", 2, "cosine", 0);
    expectError("fit lambert --model ward:ax=7000", 2, "ax", 0);
    expectError("fit lambert --model lambert --grazing-cut 0", 4, "grazing", 0);
    expectError("fit absent.binary --model lambert", 3, "absent.binary", 0);
}

// Numbers that are none, among rows that would do without them: refused with the line that holds
// them, in every text format of scattered samples.
TEST_F(Fit, ScatteredValuesThatAreNoNumbersAreRefused) {
    // "%t" is the polar angle of the row in radians, "%d" in degrees, "%v" the value.
    struct Text {
        const char *name, *head, *row;
    };
    const char* const nist =
        "0.45,-30,0,%d,0,%v,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n"
        "0.55,-30,0,%d,0,.25,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n"
        "0.65,-30,0,%d,0,.25,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
    const Text texts[] = {
        {"s.alta", "#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n", "0.5 0 %t 0 %v\n"},
        {"s.astm", "VARS theta_i,phi_i,theta_s,phi_s,a\n", "0.5,0,%t,0,%v\n"},
        {"s.brdf", "3\n450 550 650\n", "0.5 0 %t 0 .25 %v .25\n"},
        {"s.csv", "lambda,thetai,phi,thetar,phir\n", nist},
    };
    for (const Text& text : texts) {
        const auto put = [&](const std::string& odd) {
            std::string content = text.head;
            for (int row = 0; row < 20; ++row)
                for (const char* at = text.row; *at; ++at) {
                    if (*at != '%')
                        content += *at;
                    else if (*++at == 'v')
                        content += row == 7 ? odd : "0.25";
                    else
                        content += std::to_string(*at == 't' ? 0.05 * row : 3 * row);
                }
            write(text.name, content);
        };
        const std::string line =
            "fit " + path(text.name) + " --rgb --model lambert -o " + path("fit.json");
        put("0.25");
        const Answer good = run(line);
        EXPECT_EQ(good.code, 0) << text.name << " " << good.err;
        fs::remove(path("fit.json"));
        for (const char* odd : {"nan", "inf", "-inf"}) {
            put(odd);
            expectError(line, 3, odd, 1);
            expectError(line, 3, "line", 1);
        }
        fs::remove(path(text.name));
    }
}

// Coefficients ring, below zero too; what they stand for is found nevertheless: they hold 99.9 % of
// its energy, so that values err by some 4 %.
TEST_F(Fit, CoefficientFilesAreData) {
    ASSERT_EQ(
        run("project 'lambert:kd=.4 + ward:ks=.1,ax=.4,ay=.4' --cosine -o " + path("c.json")).code,
        0);
    const Answer answer = run("fit " + path("c.json") +
                              " --model lambert+ward --grazing-cut 70 -o " + path("fit.json"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const Json preset = Json::parse(read(path("fit.json")));
    for (const Json& parameter : preset["fit"]["parameters"]) {
        const double truth = parameter["name"] == "ward.ks" ? 0.1 : 0.4;
        EXPECT_NEAR(parameter["value"], truth, 0.04 * truth) << parameter["name"];
    }
}

using Names = std::multiset<std::string>;

Names namesOf(const Json& list) {
    Names names;
    for (const Json& own : list) names.insert(own["name"].get<std::string>());
    return names;
}

TEST_F(Fit, LobesOfOneModelAreNumbered) {
    const std::string job = "fit ggx:alpha=.3,F0=.5 --samples 400 --starts 2 --accept --model ";
    const Answer twice = run(job + "ggx:kd=0+ggx -o " + path("two.json"));
    ASSERT_EQ(twice.code, 0) << twice.err;
    const Json fit = Json::parse(read(path("two.json")))["fit"];
    const Names two{"ggx1.F0", "ggx1.alpha", "ggx1.ks", "ggx2.F0", "ggx2.alpha", "ggx2.ks"};
    EXPECT_EQ(namesOf(fit["parameters"]), two);
    EXPECT_EQ(namesOf(fit["held"]).count("ggx1.kd"), 1u) << fit["held"];
    EXPECT_EQ(namesOf(fit["held"]).count("ggx.kd"), 0u) << fit["held"];
    for (const std::string& name : two)
        EXPECT_NE(twice.out.find("\n  " + name + " "), std::string::npos) << twice.out;
    // One lobe made the data, so that two are not told apart.
    ASSERT_FALSE(fit["ambiguous"].empty());
    for (const Json& set : fit["ambiguous"])
        for (const Json& name : set) EXPECT_TRUE(two.contains(name.get<std::string>())) << set;
    const Answer mixed = run(job + "ggx+lambert+ggx --json");
    ASSERT_EQ(mixed.code, 0) << mixed.err;
    Names three = two;
    three.insert("lambert.kd");
    EXPECT_EQ(namesOf(Json::parse(mixed.out)["fit"]["parameters"]), three);
    // Names of single lobes have no number.
    const Answer one = run(job + "lambert+ggx --json");
    ASSERT_EQ(one.code, 0) << one.err;
    EXPECT_EQ(namesOf(Json::parse(one.out)["fit"]["parameters"]),
              (Names{"lambert.kd", "ggx.F0", "ggx.alpha", "ggx.ks"}));
    EXPECT_EQ(run("eval " + path("two.json") + " --wi 30,0 --wo 30,180").code, 0);
}

// A number behind a name could be part of it otherwise.
TEST_F(Fit, NoModelEndsInADigit) {
    const Json listed = Json::parse(run("list models --json").out);
    ASSERT_FALSE(listed["models"].empty());
    for (const Json& model : listed["models"])
        EXPECT_FALSE(std::isdigit(model["name"].get<std::string>().back())) << model["name"];
}

// A preset may hold a sum of models, and nothing else: no file, not even itself.
TEST_F(Fit, PresetsHoldSumsOfModelsOnly) {
    const auto write = [&](const std::string& spec) {
        std::ofstream(path("p.json"))
            << R"({"format": "hshfit-preset", "version": 1, "spec": ")" << spec << "\"}";
    };
    write("lambert:kd=.5 + 0.5 * lambert");
    const Answer sum = run("eval " + path("p.json") + " --wi 10,0 --wo 20,0");
    ASSERT_EQ(sum.code, 0) << sum.err;
    EXPECT_NEAR(std::stod(sum.out.substr(sum.out.find('\t') + 1)), 1 / M_PI, 1e-12);
    for (const std::string& spec :
         {path("p.json"), std::string("preset:hsh-ward"), std::string()}) {
        write(spec);
        EXPECT_EQ(run("info " + path("p.json")).code, 3) << spec;
    }
}

}  // namespace
