// Laws of the table of commands: every command has a one-line help, a source, a place in the
// docs and in the completion of shells, and an example that works as it is printed.

#include "places.h"

#include <cli/command_table.h>
#include <cli/program.h>

#include <fmt/format.h>
#include <ostream>

#include <ranges>
#include <set>
#include <string_view>
#include <vector>

namespace hshfit::cli {

/// The name of a case of a law.
void PrintTo(const Command& command, std::ostream* out) {
    *out << command.name;
}

}  // namespace hshfit::cli

namespace {

using hshfit::cli::Command;
using hshfit::cli::commands;
using hshfit::test::Answer;
using hshfit::test::Cli;

namespace fs = std::filesystem;

std::vector<std::string> wordsOf(const std::string& line) {
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    return words;
}

/// Whether the example `user` reads what the example `maker` writes with -o.
bool reads(const Command& user, const Command& maker) {
    const auto made = wordsOf(maker.example), used = wordsOf(user.example);
    for (std::size_t m = 1; m < made.size(); ++m) {
        if (made[m - 1] != "-o") continue;
        for (std::size_t u = 2; u < used.size(); ++u)
            if (used[u - 1] != "-o" && used[u].starts_with(made[m])) return true;
    }
    return false;
}

class CommandTable : public Cli, public testing::WithParamInterface<Command> {
protected:
    /// Runs the example in a folder that has the repository's examples/, after the examples that
    /// write its inputs.
    void runExample(const Command& command) {
        for (const Command& other : commands())
            if (reads(command, other)) runExample(other);
        const std::string arguments = std::string(command.example).substr(7);
        const std::string line = "cd " + folder_.string() + " && " + hshfit::test::program() + " " +
                                 arguments + " >out.txt 2>err.txt";
        ASSERT_EQ(std::system(line.c_str()), 0) << command.example << "\n" << read(path("err.txt"));
    }
};

TEST_P(CommandTable, HelpIsOneLineAndEndsInTheExample) {
    const Command& command = GetParam();
    const Answer answer = run(std::string(command.name) + " --help");
    ASSERT_EQ(answer.code, 0);
    const auto help = wordsOf(command.help), example = wordsOf(command.example);
    const auto words = wordsOf(answer.out);
    EXPECT_TRUE(std::ranges::equal(help, std::views::take(words, help.size()))) << answer.out;
    EXPECT_EQ(std::string_view(command.help).find('\n'), std::string_view::npos);
    EXPECT_TRUE(std::string(command.example).starts_with("hshfit " + std::string(command.name)));
    std::vector<std::string> last =
        wordsOf(answer.out.substr(answer.out.find("\nExample:\n") + 10));
    std::erase(last, "\\");
    EXPECT_EQ(last, example) << answer.out;
    for (const char* option : {"--json", "--quiet", "--threads"})
        EXPECT_NE(answer.out.find(option), std::string::npos) << option;
}

TEST_P(CommandTable, ExampleWorks) {
    fs::create_directory_symlink(fs::path(hshfit::test::sourceFolder()) / "examples",
                                 path("examples"));
    runExample(GetParam());
}

TEST_P(CommandTable, SourceAddsIt) {
    const std::string file = hshfit::test::sourceFolder() + "/cli/" + GetParam().file;
    EXPECT_NE(read(file).find("(CLI::App& command, Globals& globals) {"), std::string::npos)
        << file;
}

TEST_P(CommandTable, CompletionHasItAndItsOptions) {
    const std::string name = GetParam().name;
    const auto names = wordsOf(run("completion bash -- hshfit " + name.substr(0, 2)).out);
    EXPECT_NE(std::ranges::find(names, name), names.end());
    const std::vector<std::string> threads{"words", "--threads"};
    EXPECT_EQ(wordsOf(run("completion bash -- hshfit " + name + " --thr").out), threads);
}

INSTANTIATE_TEST_SUITE_P(Every, CommandTable, testing::ValuesIn(commands()),
                         [](const auto& row) { return std::string(row.param.name); });

TEST_F(Cli, HelpOfTheProgramListsEveryCommandUnderItsGroup) {
    const std::string help = run("--help").out;
    for (const Command& command : commands()) {
        const std::size_t group = help.find(fmt::format("\n{}:\n", command.group));
        const std::size_t line = help.find(fmt::format("\n  {} ", command.name));
        ASSERT_NE(group, std::string::npos) << command.group;
        ASSERT_NE(line, std::string::npos) << command.name;
        EXPECT_EQ(help.find("\n\n", group + 1) > line, group < line) << command.name;
    }
}

// The index is the first table of the page: `name …` in its first column.
TEST(CommandDocs, IndexHasExactlyTheCommandsOfTheTable) {
    std::set<std::string> known, indexed;
    for (const Command& command : commands()) known.insert(command.name);
    std::ifstream page(hshfit::test::sourceFolder() + "/docs/reference/commands.md");
    for (std::string line; std::getline(page, line) && !line.starts_with("## ");)
        if (line.starts_with("| `")) indexed.insert(wordsOf(line.substr(3))[0]);
    EXPECT_EQ(indexed, known);
}

}  // namespace
