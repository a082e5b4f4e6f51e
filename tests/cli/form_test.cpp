// The forms of `project`, and every command that reads them.

#include "program.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <vector>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

const char* const source = "lambert:kd=.1/.2/.3 + ggx:alpha=.4";

struct Case {
    const char* name;
    const char* options;
    const char* kind;
};
const std::vector<Case> cases = {
    {"half", "--outgoing 16 --precision half", "outgoing"},
    {"unorm16", "--outgoing 16 --precision unorm16", "outgoing"},
    {"unorm8", "--outgoing 24x24 --precision unorm8", "outgoing"},
    {"cosine", "--outgoing 16 --cosine --precision half", "outgoing"},
    {"rank", "--outgoing 16 --rank 3", "outgoing"},
    {"rank_error", "--outgoing 16 --rank-error 0.01", "outgoing"},
    {"keep", "--outgoing 16 --keep 800", "outgoing"},
    {"split", "--outgoing 16 --split diffuse", "outgoing"},
    {"lobe", "--outgoing 16 --split ggx:alpha=.4", "outgoing"},
    {"window", "--outgoing 16 --window lanczos", "outgoing"},
    {"both", "--form basis", "basis"},
    {"zernike", "--form basis --basis zernike --order 9 --reciprocal --precision half", "basis"},
    {"both_rank", "--form basis --order 9 --rank 3", "basis"},
    {"both_keep", "--form basis --keep 300 --precision unorm16", "basis"},
    {"halfway", "--form halfway --halfway 8,4,2 --precision half", "halfway"},
    {"halfway_reciprocal", "--form halfway --halfway 8,4,2 --reciprocal", "halfway"},
};

class Form : public Cli {
protected:
    Answer project(const Case& c) const {
        return run(std::string("project '") + source + "' " + c.options + " -o " + file(c) +
                   " --json --quiet");
    }
    std::string file(const Case& c) const { return path(std::string(c.name) + ".json"); }

    /// f at one pair, all channels.
    std::vector<double> valueOf(const std::string& spec, const std::string& pair) const {
        const Answer answer = run("eval '" + spec + "' " + pair + " --json");
        EXPECT_EQ(answer.code, 0) << answer.err;
        if (answer.code != 0) return {};
        return Json::parse(answer.out)["values"].get<std::vector<double>>();
    }
};

TEST_F(Form, HelpNamesTheFormsThatReciprocalIsFor) {
    EXPECT_NE(run("help project").out.find("With --form basis or halfway"), std::string::npos);
}

TEST_F(Form, EveryOneIsWrittenReadEvaluatedAndExported) {
    for (const Case& c : cases) {
        const Answer made = project(c);
        ASSERT_EQ(made.code, 0) << c.name << ": " << made.err;
        EXPECT_TRUE(keepsSchema(made.out, "project")) << c.name;
        const Json form = Json::parse(made.out)["representation"];
        EXPECT_EQ(form["kind"], c.kind) << c.name;
        EXPECT_GT(form["bytes"].get<int>(), 0);
        EXPECT_TRUE(keepsSchema(read(file(c)), "coefficients")) << c.name;

        const Answer info = run("info " + file(c) + " --json --quiet");
        ASSERT_EQ(info.code, 0) << c.name << ": " << info.err;
        EXPECT_TRUE(keepsSchema(info.out, "info")) << c.name;
        EXPECT_EQ(Json::parse(info.out)["representation"], form) << c.name;

        // Near the lobe, where every form is close: the peak is about 0.25 wide.
        const std::string pair = "--wi 30,170 --wo 25,0";
        const auto exact = valueOf(source, pair), found = valueOf(file(c), pair);
        ASSERT_EQ(found.size(), 3U) << c.name;
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(found[k], exact[k], 0.15 * exact[k]) << c.name;
        }

        const Answer compared = run("compare '" + std::string(source) + "' " + file(c) +
                                    " --metrics nbrdf --json --quiet");
        EXPECT_EQ(compared.code, 0) << c.name << ": " << compared.err;
        EXPECT_LT(Json::parse(compared.out)["metrics"][0]["value"], 0.06) << c.name;
    }
}

TEST_F(Form, EveryKindIsExported) {
    for (const Case& c : cases) {
        const std::string name = c.name;
        if (name != "unorm16" && name != "lobe" && name != "both" && name != "halfway") continue;
        ASSERT_EQ(project(c).code, 0) << c.name;
        const Answer exported = run("export " + file(c) + " -o " + path(c.name) +
                                    " --target bin --number float32 --allow-loss --json --quiet");
        ASSERT_EQ(exported.code, 0) << c.name << ": " << exported.err;
        const Json answer = Json::parse(exported.out);
        // Forms with a shader of their own are exported as they are.
        EXPECT_EQ(answer.contains("form"), std::string_view(c.kind) != "outgoing") << c.name;
        const Json& error = answer["fit_error"];
        if (answer.contains("form")) {
            EXPECT_EQ(error["mean_log"], error["file"]) << c.name;
            EXPECT_LT(error["mean_log"], 0.06) << c.name;
        } else {
            EXPECT_LT(error["total"], 0.4) << c.name;
        }
    }
}

TEST_F(Form, TheSameFileFromRunToRunWhateverTheThreads) {
    for (const Case& c : cases) {
        ASSERT_EQ(project(c).code, 0) << c.name;
        const std::string first = read(file(c));
        ASSERT_EQ(run(std::string("project '") + source + "' " + c.options + " -o " + file(c) +
                      " --threads 1 --quiet")
                      .code,
                  0);
        EXPECT_EQ(read(file(c)), first) << c.name;
    }
}

TEST_F(Form, CostsAreThoseOfTheReconstruction) {
    // Eight-bit coefficients against exact ones: the recorded change is the relative L2 distance.
    ASSERT_EQ(run("project phong:exponent=8 --outgoing 16 -o " + path("exact.json")).code, 0);
    const Answer rounded =
        run("project phong:exponent=8 --outgoing 16 --precision unorm8 --json -o " +
            path("rounded.json"));
    ASSERT_EQ(rounded.code, 0) << rounded.err;
    const double stated = Json::parse(rounded.out)["representation"]["steps"][0]["change"];
    const Answer compared = run("compare " + path("exact.json") + " " + path("rounded.json") +
                                " --metrics relative-l2 --json");
    const double found = Json::parse(compared.out)["metrics"][0]["value"];
    EXPECT_GT(stated, 0);
    EXPECT_NEAR(found, stated, 0.02 * stated);
}

TEST_F(Form, ContradictionsAreRefusedInOneLine) {
    const auto refuse = [&](const std::string& options, int code, const std::string& part) {
        expectError("project phong:exponent=5 " + options + " -o " + path("x.json"), code, part, 0);
    };
    refuse("--form cube", 2, "outgoing, basis, halfway");
    refuse("--form basis --outgoing 16", 2, "--outgoing belongs to");
    refuse("--form basis --basis lsosh --order 3", 2, "orthonormal");
    refuse("--form basis --reciprocal --cosine", 2, "not symmetric");
    refuse("--reciprocal", 2, "--form basis");
    refuse("--halfway 3,3,3", 2, "--form halfway");
    refuse("--form halfway --halfway 3,3", 2, "three numbers");
    refuse("--form halfway --rank 3", 2, "linear forms");
    refuse("--rank 3 --rank-error .1", 2, "not both");
    refuse("--window box", 2, "hann, lanczos, bending");
    refuse("--precision float16", 2, "float64, float32, half, unorm16, unorm8");
    refuse("--split nonsense:x=1", 2, "nonsense");
    expectError("project phong:exponent=5 --precision half -o " + path("x.exr"), 2, ".json", 0);
}

TEST_F(Form, BrokenFilesAreRefusedInOneLine) {
    const Case both{"both", "--form basis --order 3 --precision half", "basis"};
    ASSERT_EQ(project(both).code, 0);
    const Json good = Json::parse(read(file(both)));
    const auto refuse = [&](const char* pointer, const Json& value, const std::string& part) {
        Json bad = good;
        bad[Json::json_pointer(pointer)] = value;
        write("both.json", bad.dump());
        expectError("eval " + file(both) + " --wi 10,0 --wo 10,0", 3, part, 1);
    };
    refuse("/representation/kind", "cube", "kind");
    refuse("/representation/arrays/0/shape", {3, 1000000}, "cannot hold");
    refuse("/representation/arrays/0/shape", {-3, 1}, "shape");
    refuse("/representation/arrays/0/shape", Json::array(), "shape");
    refuse("/representation/arrays/0/base64", "AAAA", "base64");
    refuse("/representation/arrays/0/precision", "float16", "precision");
    refuse("/representation/arrays/0/bytes", 1e12, "bytes");
    refuse("/representation/arrays/0/name", "other", "factors of blocks");
    refuse("/representation/arrays", Json::array(), "matrix");
    refuse("/basis/order", 4, "matrix");
    refuse("/representation/added", "nonsense:x=1", "nonsense");
    write("both.json", good.dump().substr(0, good.dump().size() / 2));
    expectError("eval " + file(both) + " --wi 10,0 --wo 10,0", 3, "both.json", 1);
}

}  // namespace
}  // namespace hshfit::test
