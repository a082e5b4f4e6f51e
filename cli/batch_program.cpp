#include "batch_program.h"

#include "command.h"
#include "command_table.h"
#include "option_rows.h"
#include "run_words.h"
#include "usage_errors.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/spelling.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

namespace hshfit::cli {
namespace {

using Output = jobs::BatchCommand::Output;

/// Costs are mean processor seconds of small items: docs/reference/batch.md, "Shards".
constexpr jobs::BatchCommand items[] = {
    {.name = "project", .output = Output::file, .outputName = "coefficients.json", .cost = .006},
    {.name = "report", .output = Output::folder, .outputName = "report", .cost = .1},
    {.name = "fit", .output = Output::file, .outputName = "fit.json", .cost = .06},
    {.name = "convert", .output = Output::file, .cost = .34},
    {.name = "tradeoff", .output = Output::folder, .outputName = "tradeoff", .cost = 12},
    {.name = "export", .output = Output::folder, .outputName = "export", .cost = 2},
    {.name = "compare", .comparesTwo = true, .cost = .034},
    {.name = "info", .cost = .009},
    {.name = "eval", .cost = .002},
    {.name = "render", .output = Output::file, .outputName = "render.png", .cost = .15},
    {.name = "gaussians", .output = Output::file, .outputName = "gaussians.json", .cost = 1.3},
};

constexpr std::array<std::string_view, 6> reserved{"json",   "quiet", "threads",
                                                   "output", "force", "help"};

/// "--key=value"; a list repeats the option, true is a flag, false is none.
void addOption(std::vector<std::string>& words, const std::string& key,
               const nlohmann::json& value) {
    if (value.is_array())
        for (const auto& each : value) addOption(words, key, each);
    else if (value.is_boolean() && value.get<bool>())
        words.push_back("--" + key);
    else if (value.is_string())
        words.push_back(fmt::format("--{}={}", key, value.get<std::string>()));
    else if (!value.is_boolean())
        words.push_back(fmt::format("--{}={}", key, jsonText(value)));
}

/// A value that is none of the words of its option, "--basis=hhs"; empty if all are.
std::string unknownValue(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        const Values* row = findValues(command, *option);
        const bool closed = row && row->words && row->files == Files::none &&
                            row->syntax != Syntax::brdf && row->syntax != Syntax::light &&
                            row->syntax != Syntax::either;
        if (!closed || option->count() == 0) continue;
        const std::vector<Word> known = row->words();
        std::vector<std::string_view> names;
        for (const Word& word : known) names.push_back(word.text);
        for (const std::string& result : option->results())
            for (const std::string& part :
                 CLI::detail::split(result, row->syntax == Syntax::sum ? '+' : ',')) {
                const std::string name = part.substr(0, part.find(':'));
                if (std::ranges::find(names, name) == names.end())
                    return option->get_name() + ": " +
                           spelling::unknown("value", name, names).what();
            }
    }
    return {};
}

/// The program's options without its work.
class Check {
public:
    Check() {
        app_.require_subcommand(1);
        for (const Command& row : commands()) addCommand(app_, globals_, row);
        // Runs when all words are understood, before the command would.
        app_.parse_complete_callback([] { throw Understood(); });
    }

    bool writes(const jobs::BatchCommand& command, const std::string& option) const {
        const CLI::App* app = app_.get_subcommand(std::string(command.name));
        const CLI::Option* found = app->get_option_no_throw("--" + option);
        return found && isWritten(*app, *found);
    }

    std::vector<std::string> words(const jobs::BatchItem& item, const std::string& folder) const {
        const jobs::BatchCommand& command = items[item.command];
        const auto within = [&](const std::string& name) {
            return (std::filesystem::path(folder) / name).string();
        };
        std::vector<std::string> words{std::string(command.name)};
        for (const std::string& input : item.inputs) words.push_back(input);
        if (command.output != Output::none) {
            // convert takes the path by its place.
            if (command.name != "convert") words.emplace_back("--output");
            words.push_back(within(item.output));
        }
        for (const auto& [key, value] : item.options->items())
            addOption(
                words, key,
                writes(command, key) ? nlohmann::json(within(value.get<std::string>())) : value);
        words.insert(words.end(), {"--json", "--quiet", "--threads=1"});
        return words;
    }

    std::string mistake(const std::vector<std::string>& words) {
        CLI::App* command = app_.get_subcommand(words[0]);
        for (const std::string& word : words) {
            if (!word.starts_with("--")) continue;
            const std::string key = word.substr(2, word.find('=') - 2);
            const bool ours = std::ranges::find(reserved, key) != reserved.end();
            const bool last = word == "--json" || word == "--quiet" || word == "--threads=1" ||
                              word == "--output";
            if (ours && !last) return fmt::format("options: {} is stated by the batch itself", key);
        }
        try {
            app_.parse(std::vector<std::string>(words.rbegin(), words.rend()));
        } catch (const Understood&) {
            return unknownValue(*command);
        } catch (const CLI::ParseError& error) {
            return usageMessage(app_, error, words);
        } catch (const Error& error) {
            return error.what();
        }
        return {};
    }

private:
    struct Understood {};
    Globals globals_;
    CLI::App app_{"", "hshfit"};
};

}  // namespace

jobs::BatchProgram batchProgram() {
    const auto check = std::make_shared<Check>();
    return {
        .version = version,
        .commands = items,
        .writes = [check](const jobs::BatchCommand& command,
                          const std::string& option) { return check->writes(command, option); },
        .words = [check](const jobs::BatchItem& item,
                         const std::string& folder) { return check->words(item, folder); },
        .mistake = [check](const std::vector<std::string>& words) { return check->mistake(words); },
        .run =
            [](const std::vector<std::string>& words) {
                return runWords(words, Outputs::replaced);
            }};
}

}  // namespace hshfit::cli
