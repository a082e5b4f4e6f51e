// Laws of the rows of arguments and options: each has one, it names its files, and those that name
// what is written keep to the folder of an item of a batch.

#include "program.h"

#include <cli/batch_program.h>
#include <cli/command.h>
#include <cli/command_table.h>
#include <cli/option_rows.h>

#include <jobs/batches/program.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <map>
#include <set>

namespace hshfit::cli {
namespace {

/// Options and arguments of free text that name no file.
const std::set<std::string> plainTexts{"--axis",
                                       "--bandwidth",
                                       "--calibration",
                                       "--camera",
                                       "--detector-aperture",
                                       "--detector-zero",
                                       "--device",
                                       "--dispersion",
                                       "--euler",
                                       "--exposure",
                                       "--extensions",
                                       "--font",
                                       "--font-size",
                                       "--halfway",
                                       "--incidence-zero",
                                       "--name",
                                       "--normal",
                                       "--of",
                                       "--outgoing",
                                       "--parameter",
                                       "--prefix",
                                       "--shard",
                                       "--source-aperture",
                                       "--up",
                                       "--view",
                                       "--wi",
                                       "--wo",
                                       "WORDS"};

class OptionRows : public test::Cli {
protected:
    void SetUp() override {
        Cli::SetUp();
        for (const Command& row : commands()) addCommand(app_, globals_, row);
    }
    /// Long names of the options of a command that write, but for the result itself.
    std::vector<std::string> writingOptions(std::string_view name) const {
        const CLI::App& command = *app_.get_subcommand(std::string(name));
        std::vector<std::string> found;
        for (const CLI::Option* option : command.get_options())
            if (isWritten(command, *option) && !option->get_positional() &&
                !option->check_lname("output"))
                found.push_back(option->get_lnames().front());
        return found;
    }
    /// An item of a command with these options, as a line of a manifest.
    std::string lineOf(const jobs::BatchCommand& command, const std::string& options) const {
        std::string line = "{\"command\": \"" + std::string(command.name) +
                           "\", \"input\": \"lambert\", \"options\": " + options;
        if (command.comparesTwo) line += ", \"with\": \"lambert\"";
        if (command.output != jobs::BatchCommand::Output::none && command.outputName.empty())
            line += ", \"output\": \"l.binary\"";
        return line + "}\n";
    }

    Globals globals_;
    CLI::App app_{"", "hshfit"};
};

TEST_F(OptionRows, EveryOptionOfFreeTextStatesItsFilesOrNamesNone) {
    std::set<std::string> left = plainTexts;
    for (const CLI::App* command : app_.get_subcommands({})) {
        for (const CLI::Option* option : command->get_options()) {
            const bool text = option->get_type_name().starts_with("TEXT");
            if (!text || option->get_type_size() == 0 || !choicesOf(*option).empty()) continue;
            const Values* row = findValues(*command, *option);
            if (row && (row->files != Files::none || row->words)) continue;
            const std::string name = option->get_positional() ? option->get_name(true, false)
                                                              : "--" + option->get_lnames().front();
            left.erase(name);
            EXPECT_TRUE(plainTexts.contains(name))
                << command->get_name() << " " << name
                << ": give it a row in cli/option_rows.cpp, with its files, or name it above";
        }
    }
    EXPECT_EQ(left, std::set<std::string>{});
}

TEST_F(OptionRows, EveryArgumentAndOptionIsOfOneRow) {
    const std::set<std::string> ofEveryCommand{"help", "json", "quiet", "threads", "force"};
    for (const Command& row : commands()) {
        const CLI::App& command = *app_.get_subcommand(row.name);
        std::map<const jobs::OptionRow*, std::size_t> uses;
        for (const CLI::Option* option : command.get_options()) {
            const jobs::OptionRow* found = findRow(command, *option);
            if (found) ++uses[found];
            const bool every = !option->get_lnames().empty() &&
                               ofEveryCommand.contains(option->get_lnames().front());
            EXPECT_TRUE(found || every) << row.name << " " << option->get_name(true);
        }
        const CommandRows rows = row.options();
        for (const ArgumentRow& argument : rows.arguments)
            EXPECT_EQ(uses[&argument.row], 1U) << row.name << " " << argument.row.name;
        for (const auto table : rows.options)
            for (const jobs::OptionRow& option : table)
                EXPECT_GE(uses[&option], 1U) << row.name << " " << option.name;
    }
}

TEST_F(OptionRows, FilesThatABatchWritesByOptionsAreNamedWithinTheItem) {
    std::map<std::string, std::set<std::string>> tried;
    const jobs::BatchProgram program = batchProgram();
    for (const jobs::BatchCommand& command : program.commands) {
        for (const std::string& option : writingOptions(command.name)) {
            tried[std::string(command.name)].insert(option);
            EXPECT_TRUE(program.writes(command, option)) << command.name << option;
            std::vector<std::string> names{"/tmp/x", "../x", "a/x",         ".x",
                                           "-",      "",     "answer.json", "record.json"};
            if (!command.outputName.empty()) names.emplace_back(command.outputName);
            std::string lines;
            for (const std::string& name : names)
                lines += lineOf(command, nlohmann::json({{option, name}}).dump());
            lines += lineOf(command, "{\"" + option + "=/tmp/x\": true}");
            lines += lineOf(command, nlohmann::json({{option, {"/tmp/x"}}}).dump());
            write("m.jsonl", lines);
            const auto refused = jobs::readManifest(path("m.jsonl"), program).mistakes;
            ASSERT_EQ(refused.size(), names.size() + 2) << command.name << " " << option;
            for (std::size_t k = 0; k < refused.size(); ++k) {
                EXPECT_TRUE(refused[k].starts_with(path("m.jsonl:") + std::to_string(k + 1) + ": "))
                    << refused[k];
                EXPECT_NE(refused[k].find("give "), std::string::npos) << refused[k];
                EXPECT_NE(refused[k].find(option), std::string::npos) << refused[k];
            }
            const auto options =
                std::make_shared<const nlohmann::json>(nlohmann::json({{option, "own"}}));
            const auto words = program.words(
                {.command = static_cast<std::uint32_t>(&command - program.commands.data()),
                 .inputs = {"lambert"},
                 .output = "out",
                 .options = options},
                "/folder");
            EXPECT_NE(std::ranges::find(words, "--" + option + "=/folder/own"), words.end());
        }
    }
    EXPECT_TRUE(tried["fit"].contains("residuals"));
    EXPECT_TRUE(tried["fit"].contains("bands-to"));
    EXPECT_TRUE(tried["fit"].contains("figures"));
    EXPECT_TRUE(tried["compare"].contains("figures"));
    EXPECT_TRUE(tried["tradeoff"].contains("write-pairs"));
}

/// Two options of one item may not name one file.
TEST_F(OptionRows, FilesOfAnItemHaveNamesOfTheirOwn) {
    const jobs::BatchProgram program = batchProgram();
    const jobs::BatchCommand& fit =
        *std::ranges::find(program.commands, "fit", &jobs::BatchCommand::name);
    write("m.jsonl", lineOf(fit, R"({"model": "lambert", "residuals": "x", "figures": "x"})"));
    const auto mistakes = jobs::readManifest(path("m.jsonl"), program).mistakes;
    ASSERT_EQ(mistakes.size(), 1U);
    EXPECT_NE(mistakes[0].find("residuals \"x\": give a name"), std::string::npos) << mistakes[0];
}

}  // namespace
}  // namespace hshfit::cli
