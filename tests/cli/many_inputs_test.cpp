// Many inputs of `project`, `report`, `convert`, `info` and `export`: folders, failures that do not
// stop the others, names.

#include "program.h"

#include <nlohmann/json.hpp>

namespace hshfit::test {
namespace {

using ManyInputs = Cli;

std::ptrdiff_t lines(const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
}

TEST_F(ManyInputs, AFolderAndAModelGoOnPastAFailure) {
    fs::create_directory(path("in"));
    ASSERT_EQ(run("convert lambert " + path("in/one.alta")).code, 0);
    ASSERT_EQ(run("convert lambert:kd=.25 " + path("in/two.alta")).code, 0);
    write("in/broken.binary", "no MERL file");
    write("in/notes.md", "not of a known format: passed over");
    const std::string job =
        "project " + path("in") + " phong:exponent=5 --order 3 --outgoing 20,0 ";
    const Answer answer = run(job + "--json -o " + path("out"));
    EXPECT_EQ(answer.code, 3);
    EXPECT_EQ(lines(answer.err), 2) << answer.err;  // how many, and which
    EXPECT_NE(answer.err.find("1 of 4 inputs failed"), std::string::npos) << answer.err;
    EXPECT_NE(answer.err.find("broken.binary"), std::string::npos) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "projects"));
    const auto document = nlohmann::json::parse(answer.out);
    ASSERT_EQ(document["projections"].size(), 3u);
    ASSERT_EQ(document["failures"].size(), 1u);
    EXPECT_EQ(document["failures"][0]["spec"], path("in/broken.binary"));
    for (const auto& one : document["projections"])
        EXPECT_TRUE(keepsSchema(one.dump(), "project")) << one;
    for (const char* name : {"one.json", "two.json", "phong_exponent=5.json"})
        EXPECT_TRUE(fs::exists(path("out") + "/" + name)) << name;
    EXPECT_EQ(std::distance(fs::directory_iterator(path("out")), {}), 3);
}

/// A single input and one of many are the same work, on however many threads.
TEST_F(ManyInputs, GiveTheSameBytesAsOneByOne) {
    const std::string one = "phong:exponent=20", two = "ggx:alpha=.4";
    const std::string options = " --order 4 --outgoing 8 ";
    ASSERT_EQ(run("project " + one + options + "-o " + path("one.json")).code, 0);
    for (const char* threads : {"1", "2"}) {
        const std::string folder = path("out") + threads;
        ASSERT_EQ(
            run("project " + one + " " + two + options + "--threads " + threads + " -o " + folder)
                .code,
            0);
        EXPECT_EQ(read(folder + "/phong_exponent=20.json"), read(path("one.json")));
    }
    EXPECT_EQ(read(path("out1") + "/ggx_alpha=.4.json"), read(path("out2") + "/ggx_alpha=.4.json"));
}

TEST_F(ManyInputs, NamesThatCollideAreRefusedBeforeWorkStarts) {
    fs::create_directory(path("a"));
    fs::create_directory(path("b"));
    ASSERT_EQ(run("convert lambert " + path("a/x.alta")).code, 0);
    fs::copy_file(path("a/x.alta"), path("b/x.alta"));
    expectError("project " + path("a") + " " + path("b") + " -o " + path("out"), 2, "x.json", 2);
}

TEST_F(ManyInputs, OnlyNumbersThatDoNotExistAreExitCodeFour) {
    const std::string diverging = "ward:ax=.2,ay=.5,variant=duer";
    const Answer answer =
        run("project lambert " + diverging + " --order 2 --outgoing 30,0 -o " + path("out"));
    EXPECT_EQ(answer.code, 4);
    EXPECT_EQ(lines(answer.err), 2) << answer.err;
    EXPECT_TRUE(fs::exists(path("out") + "/lambert.json"));
    EXPECT_EQ(run("project gxx " + diverging + " --order 2 --outgoing 30,0 -o " + path("out")).code,
              3);
}

TEST_F(ManyInputs, AFolderWithoutMeasurementsIsAnInputError) {
    fs::create_directory(path("in"));
    write("in/notes.md", "nothing to project");
    expectError("project " + path("in") + " -o " + path("out"), 3, "no measured BRDF", 1);
}

TEST_F(ManyInputs, AReportLeavesOutWhatFailed) {
    write("broken.binary", "no MERL file");
    const Answer answer = run("report lambert " + path("broken.binary") +
                              " phong:exponent=5 --bases hsh --max-order 3 --outgoing 20,0 --json");
    EXPECT_EQ(answer.code, 3);
    EXPECT_EQ(lines(answer.err), 2) << answer.err;
    const auto document = nlohmann::json::parse(answer.out);
    ASSERT_EQ(document["reports"].size(), 2u);
    EXPECT_EQ(document["reports"][0]["brdf"], "lambert");
    EXPECT_EQ(document["reports"][1]["brdf"], "phong:exponent=5");
}

/// A folder of inputs like the one in docs/reference/commands.md: two measured files, coefficients,
/// others.
class ManyFiles : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        fs::create_directory(path("in"));
        ASSERT_EQ(run("convert lambert " + path("in/one.alta")).code, 0);
        ASSERT_EQ(run("convert lambert:kd=.25 " + path("in/two.alta")).code, 0);
        write("in/notes.md", "not of a known format: passed over");
    }
    std::string coefficients(const std::string& spec, const std::string& name) const {
        const std::string file = path("in/" + name);
        EXPECT_EQ(run("project " + spec + " --order 3 --outgoing 4 -o " + file).code, 0);
        return file;
    }
};

TEST_F(ManyFiles, ConvertWritesTheBytesOfOneByOneAndGoesOnPastAFailure) {
    write("in/broken.binary", "no MERL file");
    const std::string to = " --to alta:theta=4,phi=8 ";
    const Answer answer = run("convert " + path("in") + " ggx:alpha=.4 phong:exponent=5" + to +
                              "--json --quiet -o " + path("out"));
    EXPECT_EQ(answer.code, 3) << answer.err;
    EXPECT_EQ(lines(answer.err), 2) << answer.err;
    EXPECT_NE(answer.err.find("1 of 5 inputs failed"), std::string::npos) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "converts"));
    const auto document = nlohmann::json::parse(answer.out);
    ASSERT_EQ(document["conversions"].size(), 4u);
    for (const auto& one : document["conversions"]) {
        EXPECT_TRUE(keepsSchema(one.dump(), "convert")) << one;
        EXPECT_EQ(one["bytes"], fs::file_size(one["output"].get<std::string>()));
    }
    EXPECT_EQ(document["failures"][0]["spec"], path("in/broken.binary"));
    EXPECT_EQ(std::distance(fs::directory_iterator(path("out")), {}), 4);
    for (const auto& [spec, name] :
         {std::pair<std::string, std::string>{"ggx:alpha=.4", "ggx_alpha=.4"},
          {path("in/two.alta"), "two"}}) {
        ASSERT_EQ(run("convert " + spec + " " + path(name + ".alta") + to).code, 0);
        EXPECT_EQ(read(path("out/" + name + ".alta")), read(path(name + ".alta")));
    }
}

TEST_F(ManyFiles, ConvertRefusesFilesThatStandBeforeItWritesAny) {
    fs::create_directory(path("out"));
    write("out/two.binary", "mine");
    const std::string job = "convert " + path("in/one.alta") + " " + path("in/two.alta") +
                            " --to merl -o " + path("out");
    const Answer refused = run(job);
    EXPECT_EQ(refused.code, 5);
    EXPECT_EQ(lines(refused.err), 1) << refused.err;
    EXPECT_NE(refused.err.find("two.binary' exists"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
    EXPECT_FALSE(fs::exists(path("out/one.binary")));
    EXPECT_EQ(read(path("out/two.binary")), "mine");
    EXPECT_EQ(run(job + " --force").code, 0);
    EXPECT_NE(read(path("out/two.binary")), "mine");
    // One file after another says the same.
    const Answer one = run("convert lambert " + path("out/one.binary"));
    EXPECT_EQ(one.code, 5);
    EXPECT_NE(one.err.find("--force"), std::string::npos) << one.err;
}

TEST_F(ManyFiles, ConvertWithoutFormatOrFolderIsAUsageError) {
    const std::string in = path("in");
    expectError("convert " + in + " -o " + path("out"), 2, "--to", 1);
    expectError("convert lambert a.alta b.alta", 2, "-o DIR", 1);
    expectError("convert lambert", 2, "-o DIR", 1);
    expectError("convert " + in + "/one.alta " + in + "/one.alta --to merl -o " + path("out"), 2,
                "one.binary", 1);
}

TEST_F(ManyFiles, InfoOfAFolderHasTheReportOfEachFile) {
    const std::string stored = coefficients("phong:exponent=5", "stored.json");
    write("in/broken.binary", "no MERL file");
    const Answer answer = run("info " + path("in") + " lambert --json");
    EXPECT_EQ(answer.code, 3);
    EXPECT_NE(answer.err.find("1 of 5 inputs failed"), std::string::npos) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "infos"));
    const auto document = nlohmann::json::parse(answer.out);
    ASSERT_EQ(document["infos"].size(), 4u);
    const std::vector<std::string> specs{path("in/one.alta"), stored, path("in/two.alta"),
                                         "lambert"};
    std::string text;
    for (std::size_t i = 0; i < specs.size(); ++i) {
        EXPECT_EQ(document["infos"][i],
                  nlohmann::json::parse(run("info " + specs[i] + " --json").out));
        text += (i > 0 ? "\n" : "") + run("info " + specs[i]).out;
    }
    EXPECT_EQ(run("info " + path("in") + " lambert").out, text);
}

TEST_F(ManyFiles, ExportWritesTheFilesOfOneByOne) {
    const std::string first = coefficients("phong:exponent=5", "first.json");
    coefficients("ggx:alpha=.5", "second.json");
    const std::string options = " --target bin,glsl --no-error ";
    const Answer answer = run("export " + path("in") + options + "--json -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "exports"));
    const auto document = nlohmann::json::parse(answer.out);
    ASSERT_EQ(document["exports"].size(), 2u);
    for (const auto& one : document["exports"]) EXPECT_TRUE(keepsSchema(one.dump(), "export"));
    EXPECT_EQ(document["exports"][1]["folder"], path("out/second"));
    ASSERT_EQ(run("export " + first + options + "-o " + path("alone")).code, 0);
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(path("alone"))) {
        const std::string name = entry.path().filename();
        EXPECT_EQ(read(path("out/first/") + name), read(path("alone/") + name)) << name;
        ++files;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(path("out/first")), {}), files);
    fs::create_directory(path("empty"));
    EXPECT_EQ(run("export " + path("empty") + " -o " + path("none")).code, 3);
    EXPECT_EQ(run("export " + path("in") + " --target gltf -o " + path("none")).code, 2);
    EXPECT_FALSE(fs::exists(path("none")));
}

TEST_F(ManyFiles, APatternStandsForTheFilesThatMatch) {
    const Answer answer = run("project '" + path("in/*.alta") +
                              "' --order 2 --outgoing 20,0 --json -o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(nlohmann::json::parse(answer.out)["projections"].size(), 2u);
    EXPECT_TRUE(fs::exists(path("out/one.json")) && fs::exists(path("out/two.json")));
    // A product in a sum is no pattern.
    EXPECT_EQ(run("project '0.5 * lambert' --order 2 --outgoing 20,0 -o " + path("sum.json")).code,
              0);
    EXPECT_TRUE(fs::is_regular_file(path("sum.json")));
}

TEST_F(ManyFiles, CompareTakesPairsOfOneNameFromTwoFolders) {
    fs::create_directory(path("fits"));
    ASSERT_EQ(run("convert lambert " + path("fits/one.alta")).code, 0);
    ASSERT_EQ(run("convert lambert:kd=.5 " + path("fits/three.alta")).code, 0);
    const std::string job = "compare " + path("in") + " " + path("fits") + " --outgoing 4 ";
    const Answer answer = run(job + "--json");
    EXPECT_EQ(answer.code, 3);  // two and three have no partner
    EXPECT_EQ(lines(answer.err), 3) << answer.err;
    EXPECT_NE(answer.err.find("three.alta"), std::string::npos) << answer.err;
    EXPECT_TRUE(keepsSchema(answer.out, "compares"));
    const auto document = nlohmann::json::parse(answer.out);
    ASSERT_EQ(document["comparisons"].size(), 1u);
    EXPECT_EQ(document["failures"].size(), 2u);
    const Answer alone = run("compare " + path("in/one.alta") + " " + path("fits/one.alta") +
                             " --outgoing 4 --json");
    EXPECT_EQ(document["comparisons"][0], nlohmann::json::parse(alone.out));
}

TEST_F(ManyFiles, CompareTakesManyAgainstOneReference) {
    const std::string job = "compare lambert lambert:kd=.5 " + path("in") + " --outgoing 4 ";
    const Answer answer = run(job + "-o " + path("out"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    for (const char* name : {"lambert_kd=.5", "one", "two"}) {
        EXPECT_NE(answer.out.find(name), std::string::npos) << answer.out;
        EXPECT_TRUE(fs::exists(path("out") + "/" + name + "/comparison.html")) << name;
    }
    // kd = 0.5 has half of the reference: a relative L2 error of 0.5 in each metric of values.
    const std::string table = read(path("out/comparisons.csv"));
    EXPECT_EQ(lines(table), 4) << table;
    EXPECT_TRUE(table.starts_with("name,a,b,outgoing,")) << table;
    const auto document = nlohmann::json::parse(run(job + "--json").out);
    EXPECT_NEAR(document["comparisons"][0]["pairs"]["relative_l2"]["value"].get<double>(), 0.5,
                1e-9);
    const Answer again = run(job + "-o " + path("out"));
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_NE(again.out.find("kept " + path("out/one")), std::string::npos) << again.out;
    expectError("compare " + path("in") + " lambert lambert:kd=.5", 2, "one reference", 2);
}

TEST_F(ManyFiles, RenderTakesFolders) {
    const Answer answer =
        run("render " + path("in") + " lambert --size 8 --json -o " + path("a.png"));
    ASSERT_EQ(answer.code, 0) << answer.err;
    EXPECT_EQ(nlohmann::json::parse(answer.out)["spheres"].size(), 3u);
    const Answer lit = run("render " + path("in") +
                           " --light uniform: --by integration --size 8 "
                           "--samples 1 --json -o " +
                           path("b.png"));
    ASSERT_EQ(lit.code, 0) << lit.err;
    EXPECT_EQ(nlohmann::json::parse(lit.out)["pictures"].size(), 2u);
}

}  // namespace
}  // namespace hshfit::test
