// `hshfit tradeoff` as a user runs it.

#include "program.h"

#include <nlohmann/json.hpp>

#include <set>

namespace hshfit::test {
namespace {

using nlohmann::json;

constexpr const char* smallSweep =
    "--bases hsh,zernike --orders 3,5 --outgoing 8 --halfway 6,3,1 --ranks 0,1 --split none "
    "--precisions float32,unorm8 --pair-count 2048";

class TradeoffCommand : public Cli {
protected:
    Answer trade(const std::string& more) const {
        return run(std::string("tradeoff ggx:alpha=.4 ") + smallSweep + " " + more);
    }
    std::set<std::string> filesIn(const std::string& folder) const {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(path(folder))) {
            names.insert(entry.path().filename());
        }
        return names;
    }
};

TEST_F(TradeoffCommand, WritesTheSameFilesTwiceBesidesTimes) {
    ASSERT_EQ(trade("-o " + path("a")).code, 0);
    ASSERT_EQ(trade("-o " + path("b") + " --threads 1").code, 0);
    const std::set<std::string> stable{"tradeoff.json", "forms.csv", "front.csv",
                                       "tradeoff.gp",   "front.svg", "tradeoff.html"};
    const std::set<std::string> timed{"timing.json", "timing.csv", "timing_front.csv", "timing.svg",
                                      "timing.html"};
    std::set<std::string> all = stable;
    all.insert(timed.begin(), timed.end());
    EXPECT_EQ(filesIn("a"), all);
    for (const std::string& name : stable) {
        EXPECT_EQ(read(path("a/" + name)), read(path("b/" + name))) << name;
    }
    EXPECT_TRUE(keepsSchema(read(path("a/tradeoff.json")), "tradeoff"));
}

TEST_F(TradeoffCommand, TellsTheFirstFormsAndEndsInTime) {
    const Answer whole = trade("--json --no-timing");
    // Coefficients of five bands, before the long work.
    const std::size_t first = whole.err.find("so far");
    ASSERT_NE(first, std::string::npos) << whole.err;
    EXPECT_NE(whole.err.substr(first).find("--order 5"), std::string::npos) << whole.err;
    EXPECT_EQ(json::parse(trade("--json --no-timing --seconds 1000").out), json::parse(whole.out));
    const Answer none = trade("--json --no-timing --seconds 0.01");
    EXPECT_EQ(none.code, 4);
    EXPECT_NE(none.err.find("the time was over"), std::string::npos) << none.err;
}

TEST_F(TradeoffCommand, AnswersWithJsonThatKeepsItsSchema) {
    const Answer answer = trade("--json");
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "tradeoff"));
    const json document = json::parse(answer.out);
    EXPECT_EQ(document["timing"]["tradeoffs"][0]["forms"].size(),
              document["tradeoffs"][0]["forms"].size());
    const json untimed = json::parse(trade("--json --no-timing").out);
    EXPECT_FALSE(untimed.contains("timing"));
    EXPECT_EQ(untimed["tradeoffs"], document["tradeoffs"]);
    const Answer wavelets = trade("--json --no-timing --wavelets");
    EXPECT_TRUE(keepsSchema(wavelets.out, "tradeoff"));
    json with = json::parse(wavelets.out)["tradeoffs"];
    EXPECT_FALSE(with[0]["wavelets"].empty());
    with[0].erase("wavelets");
    EXPECT_EQ(with, document["tradeoffs"]);
}

/// Materials without coefficients have the errors that `compare` states at the same pairs.
TEST_F(TradeoffCommand, MeasuresFormulasAsCompareDoes) {
    const std::string asked =
        "tradeoff ggx:alpha=.4 --forms basis --bases hsh --orders 3 --json --no-timing --formulas ";
    const Answer answer = run(asked + "model,lobes");
    ASSERT_EQ(answer.code, 0) << answer.err;
    const json formulas = json::parse(answer.out)["tradeoffs"][0]["formulas"];
    ASSERT_EQ(formulas.size(), 5U);
    for (const json& formula : formulas) {
        const Answer compared =
            run("compare ggx:alpha=.4 '" + std::string(formula["spec"]) + "' --json");
        ASSERT_EQ(compared.code, 0) << compared.err;
        const json with = json::parse(compared.out);
        EXPECT_NEAR(with["pairs"]["mean_log"]["value"].get<double>(), formula["error"], 1e-12);
        EXPECT_NEAR(with["picture"]["flip"]["mean"].get<double>(),
                    formula["picture"]["flip"]["mean"], 1e-9);
    }
    const json none = json::parse(run(asked + "none").out);
    EXPECT_FALSE(none["tradeoffs"][0].contains("formulas"));
    expectError(asked + "lobe", 2, "did you mean 'lobes'", 0);
    expectError(asked + "none,model", 2, "'none' stands alone", 0);
}

/// Costs are the same as by `choose` for the same form.
TEST_F(TradeoffCommand, StatesTheCostsOfShaders) {
    const Answer answer =
        run("tradeoff ggx:alpha=.4 --forms halfway --halfway 5,4,3 --precisions half,unorm8 --json "
            "--no-timing --costs");
    if (answer.err.find("mesa-vulkan-drivers") != std::string::npos ||
        answer.err.find("built without Vulkan") != std::string::npos)
        GTEST_SKIP() << answer.err;
    ASSERT_EQ(answer.code, 0) << answer.err;
    ASSERT_TRUE(keepsSchema(answer.out, "tradeoff"));
    const json document = json::parse(answer.out)["tradeoffs"][0];
    const json chosen =
        json::parse(run("choose ggx:alpha=.4 --kinds lobes,halfway --json --seconds 8").out);
    EXPECT_EQ(document["costs"], chosen["costs"]);
    std::size_t alike = 0;
    for (const json& front : document["front"]) {
        const std::string options = document["forms"][front["form"].get<std::size_t>()]["options"];
        for (const json& row : chosen["rows"]) {
            if (row["spec"] != options) continue;
            EXPECT_EQ(row["cost"], front["cost"]) << options;
            ++alike;
        }
    }
    EXPECT_GT(alike, 0U);
}

/// On the software renderer, which tests have; its times are labelled as such.
TEST_F(TradeoffCommand, TimesTheShadersOfItsFronts) {
    const Answer answer = trade("--json --gpu --device software");
    if (answer.code == 4 && answer.err.find("Vulkan") != std::string::npos)
        GTEST_SKIP() << answer.err;
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "tradeoff"));
    const json document = json::parse(answer.out);
    const json &trade = document["tradeoffs"][0], &timed = document["timing"]["tradeoffs"][0];
    EXPECT_TRUE(timed["gpu"]["software"]);
    std::set<int> fronts, measured;
    for (const json& point : trade["front"]) fronts.insert(point["form"].get<int>());
    for (const json& point : timed["front"]) fronts.insert(point["form"].get<int>());
    std::size_t times = 0;
    for (const json& form : timed["gpu"]["forms"]) {
        measured.insert(form["form"].get<int>());
        EXPECT_NE(form["ns_per_million_pixels"].is_null(), form["reason"].is_null());
        if (form["reason"].is_null()) ++times;
    }
    EXPECT_EQ(measured, fronts);
    EXPECT_GT(times, 0u);
    ASSERT_EQ(this->trade("--gpu --device software -o " + path("gpu")).code, 0);
    EXPECT_NE(read(path("gpu/timing_gpu.csv")).find("\n1,"), std::string::npos);
    EXPECT_NE(read(path("gpu/timing.html")).find("a renderer in software"), std::string::npos);
}

TEST_F(TradeoffCommand, SaysWhyNoShaderCanBeTimed) {
    expectError("tradeoff lambert --json --device software", 2, "--device", 0);
    expectError("tradeoff lambert --json --gpu --no-timing", 2, "--no-timing", 0);
    expectError(std::string("tradeoff lambert --json --gpu --device nowhere ") + smallSweep, 4,
                "Vulkan", 0);
}

/// The commands that name the points of the front make files of the size and error that it states.
TEST_F(TradeoffCommand, NamesCommandsThatMakeItsForms) {
    const json trade = json::parse(
        this->trade("--json --no-timing --write-pairs " + path("pairs.csv")).out)["tradeoffs"][0];
    for (const json& point : trade["front"]) {
        std::string command = point["command"];
        ASSERT_EQ(command.rfind("hshfit ", 0), 0u);
        command.replace(command.find("OUT.json"), 8, path("form.json"));
        const Answer made = run(command.substr(7) + " --force");
        ASSERT_EQ(made.code, 0) << command << "\n" << made.err;
        const Answer evaluated = run("eval " + path("form.json") + " --pairs " + path("pairs.csv"));
        ASSERT_EQ(evaluated.code, 0) << evaluated.err;
        std::istringstream source(read(path("pairs.csv"))), mine(evaluated.out);
        std::string a, b;
        std::getline(source, a);
        std::getline(mine, b);
        double error = 0;
        while (std::getline(source, a) && std::getline(mine, b)) {
            double wi[6], weight = 0, f = 0, g = 0;
            ASSERT_EQ(std::sscanf(a.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &wi[0], &wi[1],
                                  &wi[2], &wi[3], &wi[4], &wi[5], &weight, &f),
                      8);
            ASSERT_EQ(std::sscanf(b.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &wi[0], &wi[1], &wi[2],
                                  &wi[3], &wi[4], &wi[5], &g),
                      7);
            error +=
                weight * std::abs(std::log1p(f * wi[2]) - std::log1p(std::max(g, 0.0) * wi[2]));
        }
        const double stated = trade["forms"][point["form"].get<std::size_t>()]["error"];
        EXPECT_NEAR(error, stated, 1e-3 * stated + 1e-6) << command;
    }
}

TEST_F(TradeoffCommand, MeasuresOnGivenPairs) {
    write("pairs.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,0,0,1\n0.6,0,0.8,0,0,1\n");
    const Answer answer = trade("--json --no-timing --pairs " + path("pairs.csv"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    const json document = json::parse(answer.out);
    EXPECT_EQ(document["tradeoffs"][0]["pairs"], 2);
    EXPECT_TRUE(document["tradeoffs"][0]["forms"][0]["metrics"]["albedo"].is_null());
}

TEST_F(TradeoffCommand, RefusesWhatItCannotDo) {
    write("angles.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n30,0,0,0,0,1\n");
    write("short.csv", "wi_x,wi_y,wi_z,wo_x,wo_y\n0,0,1,0,0\n");
    expectError("tradeoff lambert", 2, "-o DIR", 2);
    expectError("tradeoff lambert --json --light uniform", 2, "--light requires --lighting", 2);
    expectError("tradeoff lambert --json --metric nice", 2, "unknown metric", 2);
    expectError("tradeoff lambert --json --forms neural", 2, "outgoing, basis, halfway", 2);
    expectError("tradeoff lambert --json --no-timing --by-time", 2, "--by-time", 2);
    expectError("tradeoff lambert --json --max-ns 5", 2, "--by-time", 2);
    expectError("tradeoff lambert --json --constraints kind", 2, "non-negative", 2);
    expectError("tradeoff lambert --json --pairs " + path("angles.csv"), 3, "length", 2);
    expectError("tradeoff lambert --json --pairs " + path("short.csv"), 3, "wo_z", 2);
    expectError("tradeoff lambert --json --pairs " + path("absent.csv"), 3, "absent.csv", 2);
}

}  // namespace
}  // namespace hshfit::test
