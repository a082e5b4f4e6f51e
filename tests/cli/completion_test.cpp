// Completion: the program's answers, and real shells in which Tab is pressed.

#include "program.h"

#include <cli/command_table.h>

#include <brdfs/catalog.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/light/catalog.h>

#include <set>

namespace hshfit::test {
namespace {

std::string quoted(const std::string& text) {
    return "'" + text + "'";
}

class Completion : public Cli {
protected:
    /// The words that may stand in the place of the last of `words`.
    std::set<std::string> after(const std::vector<std::string>& words) const {
        std::string arguments = "completion bash -- hshfit";
        for (const std::string& word : words) arguments += " " + quoted(word);
        const Answer answer = run(arguments);
        EXPECT_EQ(answer.code, 0) << arguments << answer.err;
        std::istringstream lines(answer.out);
        std::string line;
        std::getline(lines, line);
        EXPECT_TRUE(line.starts_with("words")) << line;
        std::set<std::string> found;
        while (std::getline(lines, line)) found.insert(line);
        return found;
    }
    void expectTabsWork(const std::string& shell) const {
        const std::string ask = "command -v " + shell + " python3 >/dev/null";
        if (std::system(ask.c_str()) != 0) GTEST_SKIP() << shell << " or python3 is not installed";
        const std::string line = sourceFolder() + "/tests/cli/complete_in_shell.py " + shell + " " +
                                 program() + " >" + path("said") + " 2>&1";
        EXPECT_EQ(std::system(line.c_str()), 0) << read(path("said"));
    }
};

TEST_F(Completion, TabWorksInBash) {
    expectTabsWork("bash");
}

TEST_F(Completion, TabWorksInZsh) {
    expectTabsWork("zsh");
}

TEST_F(Completion, TabWorksInFish) {
    expectTabsWork("fish");
}

TEST_F(Completion, CommandsModelsLightsAndBasesAreThoseOfTheTables) {
    std::set<std::string> expected;
    for (const cli::Command& row : cli::commands()) expected.insert(row.name);
    EXPECT_EQ(after({""}), expected);
    expected = {"preset:", "rgb:", "grey:"};
    for (const auto& model : brdfs::models()) expected.emplace(model.name);
    EXPECT_EQ(after({"project", ""}), expected);
    expected.clear();
    for (const auto& kind : lightKinds()) expected.emplace(kind.name);
    expected.insert("studio");
    EXPECT_EQ(after({"light", ""}), expected);
    expected.clear();
    for (const auto& basis : bases::catalog()) expected.emplace(basis.name);
    EXPECT_EQ(after({"project", "lambert", "--basis", ""}), expected);
}

TEST_F(Completion, ParametersAreThoseOfTheModelThatAreNotGivenYet) {
    for (const auto& model : brdfs::models()) {
        std::set<std::string> expected;
        const std::string name = std::string(model.name) + ":";
        for (const auto& parameter : model.parameters)
            expected.insert(name + std::string(parameter.name) + "=");
        EXPECT_EQ(after({"project", name}), expected);
    }
    const auto rest = after({"project", "ward:ax=.2,"});
    EXPECT_FALSE(rest.contains("ward:ax=.2,ax="));
    EXPECT_TRUE(rest.contains("ward:ax=.2,ay="));
    EXPECT_EQ(after({"project", "2 * lambert + rgb:ggx:alph"}),
              std::set<std::string>{"2 * lambert + rgb:ggx:alpha="});
}

TEST_F(Completion, ArgumentsAreCountedPastOptionsAndTheirValues) {
    EXPECT_EQ(after({"matrix", "--order", "3", "sh", "hs"}), std::set<std::string>{"hsh"});
    EXPECT_EQ(after({"matrix", "sh", "hsh", ""}), std::set<std::string>{});
    EXPECT_EQ(after({"list", "bas"}), std::set<std::string>{"bases"});
    EXPECT_EQ(after({"nothing", ""}), std::set<std::string>{});
}

TEST_F(Completion, CompletesExactlyTheNamesThatMessagesCallKnown) {
    const std::pair<std::string, std::string> lines[] = {
        {"project lambert -o x.json --window", "project"},
        {"project lambert -o x.json --form", "project"},
        {"project lambert -o x.json --precision", "project"},
        {"project lambert -o x.json --basis", "project"},
        {"compare lambert lambert --metrics", "compare"},
        {"fit lambert --model ggx --robust", "fit"},
        {"fit lambert --model ggx --weights", "fit"},
        {"fit lambert --model ggx --loss", "fit"},
        {"convert lambert x.binary --repair", "convert"},
        {"tradeoff lambert -o x --constraints", "tradeoff"},
        {"irradiance uniform --convention", "irradiance"}};
    for (const auto& [line, command] : lines) {
        const std::string option = line.substr(line.rfind(' ') + 1);
        const std::string error = run(line + " xyzzy").err;
        const std::size_t begin = error.find("known: ");
        ASSERT_NE(begin, std::string::npos) << line << error;
        std::set<std::string> known;
        std::istringstream words(error.substr(begin + 7, error.find(';', begin) - begin - 7));
        for (std::string word; words >> word;) {
            if (word.ends_with(',')) word.pop_back();
            known.insert(word);
        }
        EXPECT_EQ(after({command, option, ""}), known) << line << error;
    }
}

}  // namespace
}  // namespace hshfit::test
