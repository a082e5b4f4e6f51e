// The program as a process: its streams, its signals, the names and texts that it prints.

#include "places.h"
#include "program.h"

#include <nlohmann/json.hpp>

#include <cctype>
#include <chrono>
#include <csignal>
#include <thread>

#include <sys/stat.h>

namespace hshfit::test {
namespace {

using Json = nlohmann::json;

const std::string escape = "\x1b[31m";

class Process : public Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        ::setenv("HSHFIT", test::program().c_str(), 1);
    }
    /// A command of the shell in the folder, with the program as $HSHFIT.
    Answer shell(const std::string& command) const {
        write("command", command);
        const std::string line = "cd " + folder_.string() + " && sh command >out 2>err";
        const int status = std::system(line.c_str());
        Answer answer{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                      read(path("out")), read(path("err"))};
        for (const char* name : {"command", "out", "err"}) fs::remove(path(name));
        return answer;
    }
    std::ptrdiff_t entries(const std::string& name = "") const {
        return std::distance(fs::directory_iterator(folder_ / name), {});
    }
    /// A folder "bin" with this as gnuplot, to be put before PATH.
    void putGnuplot(const std::string& script) const {
        fs::create_directory(path("bin"));
        write("bin/gnuplot", "#!/bin/sh\n" + script);
        fs::permissions(path("bin/gnuplot"), fs::perms::owner_all);
    }
    /// Samples of a Lambertian surface, ALTA's text format.
    void putSamples(const std::string& name) const {
        write(name, "#DIM 1 1\n#PARAM_IN COS_TH\n#PARAM_OUT INV_STERADIAN\n0.2 0.3\n1 0.3\n");
    }
};

/// A text for a terminal: lines of valid UTF-8 without control characters.
void expectPrintable(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        EXPECT_TRUE(c == '\n' || c == '\t' || (c >= ' ' && c != 0x7f))
            << static_cast<int>(c) << " in " << text;
    }
    EXPECT_NO_THROW(Json(text).dump()) << "UTF-8";
}

TEST_F(Process, AReportCutShortIsNotPutInPlace) {
    if (!hasGnuplot()) GTEST_SKIP() << noGnuplot;
    const Answer answer = shell(
        "(ulimit -f 20; $HSHFIT report ggx:alpha=.5 -o r --max-order 3 --outgoing 4 --bases hsh)");
    EXPECT_EQ(answer.code, 5) << answer.err;
    EXPECT_NE(answer.err.find("cut short"), std::string::npos) << answer.err;
    EXPECT_EQ(entries(), 0);
}

// Between the start of gnuplot and its end, which a stand-in draws out; it writes on if it lives.
TEST_F(Process, SigtermEndsGnuplotFirstAndLeavesNothing) {
    putGnuplot(
        "echo $$ >\"$PIDS\"\n"
        "svg=$(echo \"$3\" | sed 's/.*svg1*=\"\\([^\"]*\\)\".*/\\1/')\n"
        "while sleep 0.01; do echo x >>\"$svg\"; done\n");
    const std::string report = "report phong:exponent=3 --max-order 2 --outgoing 2 --bases hsh";
    const std::string compare =
        "compare lambert phong:exponent=3 --metrics relative-l2 --outgoing 2";
    for (const std::string& command : {report, compare}) {
        const Answer answer = shell(
            "PIDS=$PWD/pids PATH=$PWD/bin:$PATH $HSHFIT " + command +
            " -o r & program=$!\n"
            "while [ ! -s pids ] || [ $(cat r/.hshfit-* | wc -c) -lt 8 ]; do sleep 0.01; done\n"
            "kill -TERM $program\n"
            "wait $program\n"
            "code=$?\n"
            "kill -0 $(cat pids) 2>/dev/null && echo gnuplot lives\n"
            "ls -A r 2>/dev/null\n"
            "rm pids\n"
            "exit $code\n");
        EXPECT_EQ(answer.code, 128 + SIGTERM) << command;
        EXPECT_EQ(answer.out, "") << command;
        EXPECT_EQ(entries(), 1) << "bin: the folder goes too";
    }
}

TEST_F(Process, ASetOfManyInputsAppearsAsAWhole) {
    const std::string command =
        "$HSHFIT project lambert phong:exponent=3 --order 20 --outgoing 8x8 -o set";
    EXPECT_EQ(shell("(ulimit -f 8; " + command + ")").code, 5);
    EXPECT_EQ(entries(), 0);
    EXPECT_EQ(shell(command).code, 0);
    EXPECT_EQ(entries("set"), 2);
}

TEST_F(Process, NamesWithQuotesDrawTheirFigures) {
    if (!hasGnuplot()) GTEST_SKIP() << noGnuplot;
    putSamples("'it''s");
    const Answer answer = shell(
        "$HSHFIT report \"'it''s\" lambert -o \"''r'\" --max-order 2 "
        "--outgoing 2 --bases hsh");
    EXPECT_EQ(answer.code, 0) << answer.err;
    // Figures hold & and < as entities, quotes as they are or as entities.
    EXPECT_NE(read(path("''r'/curves.svg")).find("</svg>"), std::string::npos);
    EXPECT_NE(read(path("''r'/curves.gp")).find("\\047it\\047\\047s"), std::string::npos);
    EXPECT_EQ(shell("cd \"''r'\" && gnuplot curves.gp").code, 0);
}

TEST_F(Process, NamesOfAnyBytesArePrinted) {
    const std::string name = "a\xff" + escape + "\xc2\x9b" + "b.alta";
    putSamples(name);
    write("name", name);
    for (const std::string command :
         {"info", "info --json", "eval --wi 0,0 --wo 0,0", "eval --wi 0,0 --wo 0,0 --json",
          "project --order 2 --outgoing 2 -o c.json", "project --order 2 --outgoing 2 -o c.exr",
          "project --order 2 --outgoing 2 -o set lambert",
          "report --max-order 2 --outgoing 2 --bases hsh --json",
          "compare lambert --metrics relative-l2 --outgoing 2 --json",
          "convert out.exr --to slices:size=8 --force", "render -o p.exr --size 8 --samples 1",
          "fit --model lambert -o f.json --json"}) {
        const std::size_t space = command.find(' ');
        const Answer answer = shell("$HSHFIT " + command.substr(0, space) + " \"$(cat name)\"" +
                                    (space == command.npos ? "" : command.substr(space)));
        EXPECT_EQ(answer.code, 0) << command << ": " << answer.err;
        expectPrintable(answer.out);
        expectPrintable(answer.err);
        if (answer.out.starts_with('{')) {
            EXPECT_TRUE(Json::accept(answer.out)) << command;
        }
    }
    // A name that does not exist, within a file, and as the folder to write to.
    write("scene.json", "{\"format\": \"" + escape + "\"}");
    for (const std::string command :
         {"info \"x$(cat name)\"", "info \"none:$(cat name)\"", "plan scene.json -o plan",
          "project lambert -o \"none/$(cat name).json\"", "\"$(cat name)\""}) {
        const Answer answer = shell("$HSHFIT " + command);
        EXPECT_NE(answer.code, 0) << command;
        EXPECT_NE(answer.code, 1) << command << ": " << answer.err;
        EXPECT_NE(answer.err, "") << command;
        expectPrintable(answer.err);
    }
}

TEST_F(Process, MessagesAreShortAndKeepBothEnds) {
    const Answer answer = run("info begin" + std::string(100'000, 'x') + "end");
    EXPECT_EQ(answer.code, 2) << answer.err;
    EXPECT_LE(answer.err.size(), 500U);
    EXPECT_TRUE(answer.err.starts_with("hshfit: unknown model 'begin")) << answer.err;
    EXPECT_NE(answer.err.find("…"), std::string::npos);
    EXPECT_EQ(answer.err.back(), '\n');
    // Each of several inputs that fail has a line of its own.
    const Answer many =
        run("report a" + std::string(10'000, 'x') + " b" + std::string(10'000, 'x') + " --json");
    std::istringstream lines(many.err);
    for (std::string line; std::getline(lines, line);) EXPECT_LT(line.size(), 500U) << line;
}

TEST_F(Process, ClosedStreamsEndWithFive) {
    for (const std::string command :
         {"list", "--help", "--version", "completion bash", "eval lambert --wi 0,0 --wo 0,0"}) {
        for (const std::string streams :
             {">&-", ">&- 2>&-", "<&- >&- 2>&-", ">/dev/full", ">/dev/full 2>/dev/full"}) {
            EXPECT_EQ(shell("$HSHFIT " + command + " " + streams).code, 5) << command << streams;
        }
    }
    EXPECT_EQ(shell("$HSHFIT eval gxx --wi 0,0 --wo 0,0 >&- 2>&-").code, 2);
    EXPECT_EQ(shell("$HSHFIT nothing 2>/dev/full").code, 2);
}

// The first file that is opened has the number of a closed stream.
TEST_F(Process, ClosedStreamsDoNotBecomeTheFilesWritten) {
    const std::string command = "$HSHFIT project lambert --order 2 --outgoing 2 ";
    EXPECT_EQ(shell(command + "-o open.json").code, 0);
    EXPECT_EQ(shell(command + "-o closed.json <&- >&- 2>&-").code, 5);
    EXPECT_EQ(read(path("closed.json")), read(path("open.json")));
}

TEST_F(Process, FiguresDoNotDependOnTheTimeZone) {
    if (!hasGnuplot()) GTEST_SKIP() << noGnuplot;
    for (const std::string zone : {"UTC0", "XYZ-5:30"}) {
        const Answer answer = shell("TZ=" + zone + " $HSHFIT report lambert -o " + zone +
                                    " --max-order 2 --outgoing 2 --bases hsh");
        EXPECT_EQ(answer.code, 0) << answer.err;
    }
    for (const std::string file : {"curves.pdf", "curves.svg", "report.html"}) {
        EXPECT_GT(read(path("UTC0/" + file)).size(), 1000U);
        EXPECT_EQ(read(path("UTC0/" + file)), read(path("XYZ-5:30/" + file))) << file;
    }
}

TEST_F(Process, RangesStateTheirEnds) {
    const std::string one = "project lambert -o " + path("c.json") + " --tolerance ";
    expectError(one + "1e-14", 2, "--tolerance: '1e-14' is not within 1e-13 to 1", 0);
    expectError(one + "many", 2, "'many' is not within 1e-13 to 1", 0);
    expectError(one + "nan", 2, "'nan' is not within 1e-13 to 1", 0);
    expectError("report lambert --json --max-evaluations 1", 2, "is not within 1000 to 1e+12", 0);
    expectError("report lambert --json --max-order 0", 2, "'0' is not within 1 to 1000", 0);
    expectError("list --threads -1", 2, "'-1' is not within 0 to 4096", 0);
    EXPECT_EQ(run(one + "1e-13 --outgoing 0,0 --order 1").code, 0);
}

TEST_F(Process, PresetNamesMayHoldColons) {
    write("set.json", R"({"format":"hshfit-presets","version":1,"help":"two","source":"here",)"
                      R"("model":"lambert","materials":{"red: light":{"kd":0.25},)"
                      R"("red: dark: matt":{"kd":0.125}}})");
    for (const auto& [name, kd] : {std::pair("red: light", 0.25), {"red: dark: matt", 0.125}}) {
        const Answer answer =
            shell("$HSHFIT eval 'set.json:" + std::string(name) + "' --wi 0,0 --wo 0,0 --json");
        ASSERT_EQ(answer.code, 0) << answer.err;
        EXPECT_NEAR(Json::parse(answer.out)["values"][0].get<double>(), kd / std::acos(-1), 1e-12);
    }
}

// eon has a lobe that does not depend on its roughness where the data are a mirror's: searches
// fail.
TEST_F(Process, CeresSpeaksThroughTheProgramOrNotAtAll) {
    const std::string command = "fit ggx:alpha=.2 --model eon --samples 500";
    const Answer quiet = run(command + " --quiet"), loud = run(command);
    EXPECT_EQ(quiet.out, loud.out);
    EXPECT_EQ(quiet.code, loud.code);
    for (const Answer& answer : {quiet, loud}) {
        std::istringstream lines(answer.err);
        for (std::string line; std::getline(lines, line);)
            EXPECT_TRUE(line.starts_with("hshfit: ")) << line;
    }
    EXPECT_LE(std::count(quiet.err.begin(), quiet.err.end(), '\n'), quiet.code == 0 ? 0 : 1);
}

TEST_F(Process, ListsWithSpacesAreRefusedInThoseWords) {
    const std::string words = "commas separate the values, without spaces: ";
    const std::string end = " phong:exponent=3 -o r";
    expectError("tradeoff --orders 3 5" + end, 2, words + "--orders 3,5", 0);
    expectError("tradeoff --orders 3, 5 7" + end, 2, words + "--orders 3,5,7", 0);
    expectError("tradeoff --orders=3 5" + end, 2, words + "--orders 3,5", 0);
    expectError("tradeoff --precisions half unorm8" + end, 2, words + "--precisions half,unorm8",
                0);
    expectError("tradeoff --forms outgoing basis" + end, 2, words + "--forms outgoing,basis", 0);
    expectError("report --bases hsh sh" + end, 2, words + "--bases hsh,sh", 0);
    expectError("project --outgoing 45 90 phong:exponent=3 -o c.json", 2,
                words + "--outgoing 45,90", 0);
    expectError("eval lambert --wi 0 0 --wo 0,0", 2, words + "--wi 0,0", 0);
    // A file of that name is a file.
    putSamples("5");
    EXPECT_EQ(shell("$HSHFIT project --outgoing 2 5 --order 2 -o c.json").code, 0);
}

}  // namespace
}  // namespace hshfit::test
