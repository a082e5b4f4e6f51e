// Many inputs of `project` and `report`: folders, failures that do not stop the others, names.

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

}  // namespace
}  // namespace hshfit::test
