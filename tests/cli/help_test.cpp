// Pages of help: their width, their content at every width, colours, and the words that name them.

#include "program.h"

#include <cli/command_table.h>
#include <cli/topics.h>

namespace hshfit::test {
namespace {

/// The arguments of every command line that prints help.
std::vector<std::string> helpLines() {
    std::vector<std::string> lines{"help", "--help"};
    for (const cli::Command& command : cli::commands()) {
        lines.push_back(std::string(command.name) + " --help");
        lines.push_back(std::string("help ") + command.name);
    }
    for (const cli::Topic& topic : cli::topics())
        lines.push_back(std::string("help ") + topic.name);
    return lines;
}

std::vector<std::string> wordsOf(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> words;
    for (std::string word; in >> word;)
        if (word != "\\") words.push_back(word);
    return words;
}

std::size_t columnsOf(const std::string& line) {
    return static_cast<std::size_t>(
        std::ranges::count_if(line, [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

class Help : public Cli {
protected:
    /// Standard output and error of the program on a terminal of 60 columns.
    std::string onTerminal(const std::string& variables, const std::string& arguments) const {
        const std::string script = "stty cols 60; env -u NO_COLOR -u COLUMNS TERM=xterm " +
                                   variables + " " + program() + " " + arguments;
        const std::string line =
            "script -qec '" + script + "' /dev/null >" + path("seen") + " 2>&1 </dev/null";
        EXPECT_NE(std::system(line.c_str()), -1);
        return read(path("seen"));
    }
    /// Standard output for a stated width.
    std::string at(int columns, const std::string& arguments) const {
        ::setenv("COLUMNS", std::to_string(columns).c_str(), 1);
        const Answer answer = run(arguments);
        ::unsetenv("COLUMNS");
        EXPECT_EQ(answer.code, 0) << arguments << answer.err;
        return answer.out;
    }
};

// A line may be longer only if it is one word and cannot be broken.
TEST_F(Help, LinesAreWithinTheWidthAndNoWordIsLost) {
    for (const std::string& arguments : helpLines()) {
        const auto whole = wordsOf(at(100, arguments));
        for (const int width : {60, 80, 100}) {
            const std::string text = at(width, arguments);
            EXPECT_EQ(wordsOf(text), whole) << arguments << " at " << width;
            std::istringstream in(text);
            for (std::string line; std::getline(in, line);)
                EXPECT_TRUE(columnsOf(line) <= std::size_t(width) || wordsOf(line).size() == 1)
                    << arguments << " at " << width << ": " << line;
        }
    }
}

TEST_F(Help, OfACommandIsTheSameByBothWays) {
    for (const cli::Command& command : cli::commands())
        EXPECT_EQ(run(std::string("help ") + command.name).out,
                  run(std::string(command.name) + " --help").out);
    EXPECT_EQ(run("help").out, run("--help").out);
}

TEST_F(Help, ListsEveryCommandAndTopic) {
    const auto words = wordsOf(run("help").out);
    for (const cli::Command& command : cli::commands())
        EXPECT_NE(std::ranges::find(words, command.name), words.end()) << command.name;
    for (const cli::Topic& topic : cli::topics())
        EXPECT_NE(std::ranges::find(words, topic.name), words.end()) << topic.name;
}

TEST_F(Help, AloneTheProgramShowsGroupsAndThreeExamplesAndEndsInTwo) {
    const Answer answer = run("");
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(answer.out, "");
    for (const cli::Command& command : cli::commands())
        EXPECT_NE(answer.err.find(command.group), std::string::npos) << command.group;
    const std::size_t begin = answer.err.find("Examples:"), end = answer.err.find("More:");
    ASSERT_LT(begin, end);
    std::size_t examples = 0;
    for (std::size_t at = begin; (at = answer.err.find("\n  hshfit ", at)) < end; ++at) ++examples;
    EXPECT_EQ(examples, 3U);
}

TEST_F(Help, TopicsHaveTheRowsOfTheTables) {
    const auto has = [&](const std::string& topic, const std::string& part) {
        const std::string text = run("help " + topic).out;
        EXPECT_NE(text.find("\n  " + part + " "), std::string::npos) << topic << text;
    };
    has("specifications", "lambert");
    has("lights", "preetham");
    has("losses", "cube-root");
    has("exit-codes", "5");
    has("bases", "hsh");
    has("formats", "merl");
}

TEST_F(Help, UnknownWordsAreRefusedWithTheNearest) {
    expectError("help projct", 2, "did you mean 'project'?", 0);
    expectError("--versoin", 2, "unknown option '--versoin' (did you mean '--version'?)", 0);
    expectError("list base", 2, "unknown value 'base' (did you mean 'bases'?); known: ", 0);
    expectError("help loses", 2, "did you mean 'losses'?", 0);
    expectError("fit lambert", 2, "; see hshfit help fit", 0);
}

TEST_F(Help, ColoursAreForTerminalsOnlyAndNoColorTurnsThemOff) {
    if (std::system("script -qec true /dev/null >/dev/null 2>&1 </dev/null") != 0)
        GTEST_SKIP() << "script (bsdutils) is not installed";
    EXPECT_NE(onTerminal("", "help project").find("\x1b[1mOptions:"), std::string::npos);
    EXPECT_NE(onTerminal("", "eval gxx").find("\x1b[1;31mhshfit:"), std::string::npos);
    EXPECT_EQ(onTerminal("NO_COLOR=1", "help project").find('\x1b'), std::string::npos);
    EXPECT_EQ(onTerminal("NO_COLOR=1", "eval gxx").find('\x1b'), std::string::npos);
    EXPECT_EQ(onTerminal("TERM=dumb", "help project").find('\x1b'), std::string::npos);
    EXPECT_EQ(run("help project").out.find('\x1b'), std::string::npos);
    EXPECT_EQ(run("eval gxx").err.find('\x1b'), std::string::npos);
    std::istringstream lines(onTerminal("NO_COLOR=1", "help project"));
    for (std::string line; std::getline(lines, line);) {
        if (line.ends_with('\r')) line.pop_back();
        EXPECT_LE(columnsOf(line), 60U) << line;
    }
}

TEST_F(Help, ResultsAreFoldedOnTerminalsOnly) {
    if (std::system("script -qec true /dev/null >/dev/null 2>&1 </dev/null") != 0)
        GTEST_SKIP() << "script (bsdutils) is not installed";
    const std::string command = "compare ggx:alpha=.3 lambert+ggx:alpha=.2 --outgoing 30,0";
    const std::string whole = run(command).out, seen = onTerminal("NO_COLOR=1", command);
    EXPECT_EQ(wordsOf(seen), wordsOf(whole));
    bool isLong = false;
    std::istringstream before(whole), lines(seen);
    for (std::string line; std::getline(before, line);) isLong |= columnsOf(line) > 60;
    EXPECT_TRUE(isLong);
    for (std::string line; std::getline(lines, line);) {
        if (line.ends_with('\r')) line.pop_back();
        EXPECT_LE(columnsOf(line), 60U) << line;
    }
    // Code is copied from a terminal: a remark that is broken would become code.
    const std::string code = onTerminal("NO_COLOR=1", "irradiance uniform --convention three");
    EXPECT_NE(code.find("from nine coefficients of radiance: the\r\n// numbers of a LightProbe, "),
              std::string::npos)
        << code;
    EXPECT_NE(code.find("errors against direct integration\r\n    at 2000"), std::string::npos);
    // So is a command: lines of a shell end where they are broken.
    const std::string choice =
        onTerminal("NO_COLOR=1", "choose lambert --kinds gltf --for gltf -o " + path("choice"));
    EXPECT_NE(
        choice.find("\r\n  hshfit export lambert --target gltf --name lambert -o lambert\r\n"),
        std::string::npos)
        << choice;
    // JSON is for programs: a line stays whole.
    const std::string json = onTerminal("NO_COLOR=1", "info ggx:alpha=.3 --json");
    EXPECT_NE(json.find("\n"), std::string::npos);
    EXPECT_EQ(wordsOf(json), wordsOf(run("info ggx:alpha=.3 --json").out));
}

}  // namespace
}  // namespace hshfit::test
