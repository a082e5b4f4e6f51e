#include "manifest.h"

#include <jobs/common/inputs.h>
#include <jobs/source/source.h>
#include "program.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/specification/parameters.h>
#include <hshfit/spelling.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <unordered_map>

namespace hshfit::jobs {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr std::size_t longestLine = 1 << 20, longestName = 200;
constexpr int deepestLine = 8;

/// The defaults of all lines, and mistakes of parts that lines share.
struct Reading {
    const BatchProgram& program;
    Manifest manifest = {};
    json defaults = json::object();
    std::unordered_map<std::string, std::string> mistakesOfInputs = {}, mistakesOfOptions = {};
    std::unordered_map<std::string, std::shared_ptr<const json>> options = {};
    std::unordered_map<std::string, std::size_t> lineOfName = {};
};

void requireKnownKeys(const json& object, std::span<const std::string_view> known,
                      const std::string& where) {
    for (const auto& [key, value] : object.items())
        if (std::ranges::find(known, key) == known.end())
            throw InputError(where + ": " + spelling::unknown("key", key, known).what());
}

/// The files of a folder or a pattern; the specification itself if it is neither. A specification
/// is taken for a pattern where it has the characters of one and is no model or sum of models.
std::vector<std::string> filesOfInput(const std::string& spec) {
    std::vector<std::string> files = expandInputs({spec});
    const bool itself = files.size() == 1 && files[0] == spec;
    if (itself && isPattern(spec)) throw InputError(fmt::format("no file matches '{}'", spec));
    return files;
}

/// Measurements are opened to see whether they can be read; models and presets are parsed.
std::string mistakeOfInput(const std::string& spec) {
    const std::string path(pathIn(spec));
    try {
        if (path.empty()) {
            openSource(spec, false, Sides::either);
        } else if (!std::ifstream(path, std::ios::binary)) {
            return fmt::format("{}: {}", path, std::strerror(errno));
        }
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

std::vector<std::string> wordsOrWord(const json& value, const char* key, const std::string& where) {
    std::vector<std::string> words;
    const bool list = value.is_array();
    for (const json& each : list ? value : json::array({value})) {
        if (!each.is_string() || each.get_ref<const std::string&>().empty())
            throw InputError(
                fmt::format("{}: {}: give a specification, or a list of them", where, key));
        words.push_back(each);
    }
    if (words.empty()) throw InputError(fmt::format("{}: {}: the list is empty", where, key));
    return words;
}

std::string textOf(const json& line, const char* key, const std::string& where) {
    if (!line.contains(key)) return {};
    if (!line[key].is_string()) throw InputError(fmt::format("{}: {}: give a text", where, key));
    return line[key];
}

void replaceAll(std::string& text, std::string_view what, const std::string& with) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
        text.replace(at, what.size(), with);
}

/// A name from its template, with characters that are special to file systems as '_'.
std::string nameOfItem(std::string name, const BatchItem& item, std::string_view command) {
    const std::string& input = item.inputs.front();
    replaceAll(name, "{stem}", nameOf(input));
    replaceAll(name, "{parent}", nameOf(fs::path(input).parent_path().filename().string()));
    replaceAll(name, "{command}", std::string(command));
    replaceAll(name, "{line}", std::to_string(item.line));
    std::ranges::replace(name, ',', '_');
    return name;
}

void requireName(const std::string& name, const std::string& where) {
    const bool plain = std::ranges::all_of(name, [](unsigned char c) {
        return std::isalnum(c) ||
               std::string_view("._=+-").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (name.empty() || name.size() > longestName || name[0] == '.' || !plain)
        throw InputError(
            fmt::format("{}: name '{}': give 1 to {} letters, digits and . _ = + -, "
                        "without a dot at its beginning",
                        where, name, longestName));
}

/// The default options, if they are for this command, overridden by the options of the line; null
/// takes an option away.
json mergedOptions(const Reading& reading, const json& line, std::string_view command,
                   const std::string& where) {
    const json& defaults = reading.defaults;
    json options = json::object();
    const bool same = defaults.value("command", std::string(command)) == command;
    if (same && defaults.contains("options")) options = defaults["options"];
    if (line.contains("options")) {
        if (!line["options"].is_object())
            throw InputError(where + ": options: give an object, {\"order\": 7}");
        options.merge_patch(line["options"]);
    }
    for (const auto& [key, value] : options.items())
        if (key.find('=') != std::string::npos)
            throw InputError(fmt::format(
                "{}: options: '{}' is no name of an option; give {{\"order\": 7}}", where, key));
    return options;
}

std::uint32_t commandIndex(const Reading& reading, const json& line, const std::string& where) {
    std::string name = textOf(line, "command", where);
    if (name.empty()) name = textOf(reading.defaults, "command", where);
    const auto names = spelling::namesOf(reading.program.commands);
    if (name.empty()) throw InputError(where + ": command is missing, for example \"project\"");
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
        throw InputError(where + ": " + spelling::unknown("command", name, names).what());
    return static_cast<std::uint32_t>(found - names.begin());
}

std::string outputOf(const json& line, const BatchCommand& command, const std::string& where) {
    std::string output = textOf(line, "output", where);
    if (output.empty()) output = command.outputName;
    if (command.output == BatchCommand::Output::none) {
        if (!output.empty())
            throw InputError(
                fmt::format("{}: output: {} writes nothing but its answer", where, command.name));
        return output;
    }
    if (output.empty())
        throw InputError(fmt::format("{}: output is missing: the name of the file that {} writes",
                                     where, command.name));
    return output;
}

/// An item writes into its own folder, each file and folder under a name of its own.
void requireOwnNames(const BatchItem& item, const BatchProgram& program, const std::string& where) {
    const BatchCommand& command = program.commands[item.command];
    std::vector<std::string> taken{"answer.json", "record.json"};
    const auto take = [&](const std::string& key, const json& value) {
        const std::string name = value.is_string() ? value.get<std::string>() : "";
        if (name.empty() || name.find('/') != std::string::npos || name[0] == '.' ||
            name[0] == '-' || std::ranges::find(taken, name) != taken.end())
            throw InputError(fmt::format(
                "{}: {} {}: give a name within the item's folder, without a folder, other than {}",
                where, key, jsonText(value), fmt::join(taken, ", ")));
        taken.push_back(name);
    };
    if (!item.output.empty()) take("output", item.output);
    for (const auto& [key, value] : item.options->items())
        if (program.writes(command, key)) take(key, value);
}

/// Adds an item after checking its input, its options and its name.
void addItem(Reading& reading, BatchItem item, const std::string& name, const std::string& where) {
    const BatchCommand& command = reading.program.commands[item.command];
    item.name = nameOfItem(name, item, command.name);
    requireName(item.name, where);
    for (const std::string& input : item.inputs) {
        const auto [found, isNew] = reading.mistakesOfInputs.try_emplace(input);
        if (isNew) found->second = mistakeOfInput(input);
        if (!found->second.empty()) throw InputError(where + ": " + found->second);
    }
    const std::string signature =
        fmt::format("{} {} {}", command.name, item.output, jsonText(*item.options));
    const auto [mistake, isNew] = reading.mistakesOfOptions.try_emplace(signature);
    if (isNew) mistake->second = reading.program.mistake(reading.program.words(item, {}));
    if (!mistake->second.empty()) throw InputError(where + ": " + mistake->second);
    const auto [other, isFree] = reading.lineOfName.try_emplace(item.name, item.line);
    if (!isFree)
        throw InputError(
            fmt::format("{}: the name '{}' is taken by line {}; give a \"name\", "
                        "for example \"{{parent}}-{{stem}}-{{command}}\"",
                        where, item.name, other->second));
    reading.manifest.items.push_back(std::move(item));
}

void readDefaults(Reading& reading, const json& line, const std::string& where) {
    constexpr std::array<std::string_view, 5> keys{"command", "options", "output", "name", "cost"};
    const json& defaults = line["defaults"];
    if (line.size() > 1 || !defaults.is_object())
        throw InputError(where + ": the line of the defaults has one key, \"defaults\", an object");
    if (reading.manifest.items.size() + reading.manifest.mistakes.size() > 0)
        throw InputError(where + ": the defaults have to be the first line");
    requireKnownKeys(defaults, keys, where);
    if (defaults.contains("options") && !defaults["options"].is_object())
        throw InputError(where + ": options: give an object, {\"order\": 7}");
    for (const char* key : {"command", "output", "name"}) textOf(defaults, key, where);
    reading.defaults = defaults;
}

void readItems(Reading& reading, json line, std::size_t number, const std::string& where) {
    constexpr std::array<std::string_view, 7> keys{"command", "input", "with", "options",
                                                   "output",  "name",  "cost"};
    requireKnownKeys(line, keys, where);
    BatchItem item{.line = number, .command = commandIndex(reading, line, where)};
    const BatchCommand& command = reading.program.commands[item.command];
    const bool sameCommand =
        reading.defaults.value("command", std::string(command.name)) == command.name;
    for (const char* key : {"output", "name", "cost"})
        if (sameCommand && !line.contains(key) && reading.defaults.contains(key))
            line[key] = reading.defaults[key];
    item.output = outputOf(line, command, where);
    const json options = mergedOptions(reading, line, command.name, where);
    auto& shared = reading.options[jsonText(options)];
    if (!shared) shared = std::make_shared<const json>(options);
    item.options = shared;
    requireOwnNames(item, reading.program, where);
    if (line.contains("cost")) {
        if (!line["cost"].is_number() || !(line["cost"].get<double>() > 0))
            throw InputError(where + ": cost: give a number above 0, such as seconds");
        item.cost = line["cost"];
    }
    const std::string second = textOf(line, "with", where);
    if (command.comparesTwo == second.empty())
        throw InputError(fmt::format("{}: with{} {} takes {}", where,
                                     command.comparesTwo ? " is missing:" : ":", command.name,
                                     command.comparesTwo ? "a second input" : "one input"));
    std::string name = textOf(line, "name", where);
    if (name.empty()) name = "{stem}-{command}";
    if (!line.contains("input"))
        throw InputError(where + ": input is missing: a specification, a file or a glob");
    for (const std::string& spec : wordsOrWord(line["input"], "input", where)) {
        std::vector<std::string> files;
        try {
            files = filesOfInput(spec);
        } catch (const Error& error) {
            throw InputError(where + ": " + error.what());
        }
        for (const std::string& file : files) {
            BatchItem each = item;
            each.inputs = {file};
            if (command.comparesTwo) each.inputs.push_back(second);
            addItem(reading, std::move(each), name, where);
        }
    }
}

void readLine(Reading& reading, const std::string& text, std::size_t number,
              const std::string& path) {
    const std::string where = fmt::format("{}:{}", path, number);
    if (text.find_first_not_of(" \t\r") == std::string::npos) return;
    if (text.size() > longestLine)
        throw InputError(fmt::format("{}: the line is longer than {} bytes", where, longestLine));
    json line = parseJson(text, where, deepestLine);
    if (!line.is_object()) throw InputError(where + ": give an object on each line");
    if (line.contains("defaults"))
        readDefaults(reading, line, where);
    else
        readItems(reading, std::move(line), number, where);
}

}  // namespace

Manifest readManifest(const std::string& path, const BatchProgram& program) {
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    std::error_code error;
    if (!file || fs::is_directory(path, error))
        throw InputError(fmt::format(
            "{}: {}", path, fs::is_directory(path, error) ? "a folder" : std::strerror(errno)));
    Reading reading{.program = program};
    std::string text;
    for (std::size_t number = 1; std::getline(file, text); ++number) {
        try {
            readLine(reading, text, number, path);
        } catch (const Error& mistake) {
            reading.manifest.mistakes.emplace_back(mistake.what());
        }
    }
    if (file.bad()) throw InputError(fmt::format("{}: {}", path, std::strerror(errno)));
    if (reading.manifest.items.empty() && reading.manifest.mistakes.empty())
        throw InputError(path +
                         ": no items; give one JSON object on each line, "
                         "{\"command\": \"project\", \"input\": \"phong:exponent=22\"}");
    return std::move(reading.manifest);
}

}  // namespace hshfit::jobs
