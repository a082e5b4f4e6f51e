#include "outputs.h"

#include "command.h"
#include "option_rows.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/output_folder.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/files/standard_streams.h>
#include <hshfit/version.h>

#include <jobs/common/inputs.h>
#include <jobs/common/kept_outputs.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string nameOf(const CLI::Option& option) {
    return option.get_lnames().empty() ? option.get_name() : "--" + option.get_lnames().front();
}

bool isAnyOf(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, name) != names.end();
}

/// Whether the option names what each run of the command writes anew.
bool isOutput(const CLI::App& command, const CLI::Option& option) {
    // With a folder for the results, convert's second argument is an input.
    if (nameOf(option) == "OUT") return command.get_option("--output")->count() == 0;
    const Values* row = findValues(command, option);
    return row && (row->files == Files::written || row->files == Files::folder);
}

/// Whether results do not depend on the option.
bool isAside(const CLI::App& command, std::string_view name) {
    // A bound of memory lets a cache of radiance forget records.
    if (name == "--memory") return command.get_name() != "illuminate";
    return isAnyOf(name, {"--json", "--quiet", "--threads", "--force", "--help", "--records",
                          "--progress", "--all", "--writes"});
}

struct Words {
    Json options = Json::object();
    std::vector<std::string> inputs, outputs;
};

/// The words of the command, in the order of its options. A value stands for the bytes of the
/// files that it names; an option that is not given, for its default.
Words wordsOf(const CLI::App& command) {
    Words words;
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = nameOf(*option);
        const std::vector<std::string> given =
            option->count() > 0 ? option->results() : std::vector<std::string>{};
        if (isOutput(command, *option)) {
            for (const std::string& path : given)
                if (!isStandardOutput(path)) words.outputs.push_back(path);
        } else if (option->get_positional()) {
            words.inputs.insert(words.inputs.end(), given.begin(), given.end());
        } else if (name == "--records" && !given.empty()) {
            words.options[name] = true;  // they were handed on
        } else if (!isAside(command, name)) {
            Json values = Json::array();
            for (const std::string& value : given)
                values.push_back(jobs::namesFile(value) ? jobs::contentOf(value) : value);
            if (given.empty() && !option->get_default_str().empty())
                values.push_back(option->get_default_str());
            if (!values.empty()) words.options[name] = values;
        }
    }
    return words;
}

/// Throws UsageError where two of the files that the command writes are one.
void refuseTwice(const CLI::App& command) {
    std::map<std::filesystem::path, std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        const Values* row = findValues(command, *option);
        if (!row || row->files != Files::written || !isOutput(command, *option)) continue;
        for (const std::string& path : option->results()) {
            if (isStandardOutput(path)) continue;
            const auto place = std::filesystem::absolute(path).lexically_normal();
            const auto [first, added] = names.emplace(place, nameOf(*option));
            if (!added)
                throw UsageError(
                    fmt::format("{}: {} and {} both write '{}': give each a file of "
                                "its own",
                                command.get_name(), first->second, nameOf(*option), path));
        }
    }
}

/// Throws OutputError, before the work, for a file in a folder that is not there.
void requireFolders(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        const Values* row = findValues(command, *option);
        if (!row || row->files != Files::written || !isOutput(command, *option)) continue;
        for (const std::string& path : option->results())
            if (!isStandardOutput(path)) requireOutputFolder(path);
    }
}

bool writesFiles(const CLI::App& command) {
    return std::ranges::any_of(command.get_options(), [&](const CLI::Option* option) {
        return option->get_name() == "OUT" || isOutput(command, *option);
    });
}

/// Commands of which each input has a file or folder of its own: their jobs see to each.
bool isItemwise(const CLI::App& command, const Words& words) {
    const std::string& name = command.get_name();
    if (name == "fit") return command.get_option("--all")->count() > 0;
    if (name == "convert") return command.get_option("--output")->count() > 0;
    // One BRDF goes to a file; the job refuses a folder.
    if (name == "project" && std::filesystem::is_directory(words.outputs.front())) return true;
    const bool isCompare = name == "compare";
    if (isCompare && words.inputs.size() == 2)
        return jobs::areMany({words.inputs[0]}) || jobs::areMany({words.inputs[1]});
    return (isCompare || name == "project" || name == "export") && jobs::areMany(words.inputs);
}

void sayKept(const CLI::App& command, const std::vector<std::string>& outputs,
             const Globals& globals) {
    if (globals.json) {
        printJson({{"format", "hshfit-kept"},
                   {"version", 1},
                   {"command", command.get_name()},
                   {"kept", outputs},
                   {"exit_code", globals.exitCode}});
        return;
    }
    std::string text;
    for (const std::string& output : outputs) text += jobs::keptLine(output) + "\n";
    printText(text);
    if (globals.exitCode != 0)
        note(globals, fmt::format("the exit code is {}, as of the run that made it; --force shows "
                                  "why again",
                                  globals.exitCode));
}

/// The rule's facts and the key of all inputs; none where an input cannot be read, which the
/// command itself reports.
std::string stateKey(OutputRule& rule, const Words& words) {
    const Json facts = {
        {"version", version}, {"command", rule.command}, {"options", words.options}};
    rule.facts = jsonText(facts);
    setOutputRule(rule);
    try {
        rule.key = jobs::keyOf(words.inputs);
    } catch (const Error&) {
        rule.facts.clear();
    }
    setOutputRule(rule);
    return rule.key;
}

}  // namespace

void addForce(CLI::App& command, Globals& globals) {
    if (command.get_option_no_throw("--force") || !writesFiles(command)) return;
    command.add_flag("--force", globals.force, "Replace files that are not valid any more");
}

bool areOutputsKept(const CLI::App& command, Globals& globals) {
    setOutputRule({});
    // A batch keeps its results by a rule of its own.
    if (command.get_name() == "batch" || !writesFiles(command)) return false;
    refuseTwice(command);
    requireFolders(command);
    const CLI::Option* force = command.get_option_no_throw("--force");
    OutputRule rule{.replace = force && force->count() > 0, .command = command.get_name()};
    setOutputRule(rule);
    Words words;
    try {
        words = wordsOf(command);
    } catch (const Error&) {
        return false;  // of an input, which the command itself reports
    }
    if (words.outputs.empty()) return false;
    const std::string key = stateKey(rule, words);
    if (isItemwise(command, words)) return false;
    // Records are added to even where the pictures are valid.
    if (words.options.contains("--records")) return false;
    const auto [found, exitCode] = jobs::findOutputs(words.outputs, key);
    switch (found) {
        case jobs::Found::valid:
            globals.exitCode = exitCode;
            sayKept(command, words.outputs, globals);
            return true;
        case jobs::Found::incomplete:
            rule.replace = true;
            setOutputRule(rule);
            return false;
        case jobs::Found::toMake:
            return false;
    }
    return false;
}

void noteKeptFiles(const Globals& globals) {
    for (const std::string& file : takeKeptFiles())
        note(globals, fmt::format("kept {}: the same bytes would be written", file));
}

}  // namespace hshfit::cli
