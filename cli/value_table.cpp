#include "value_table.h"

#include "command_table.h"
#include "job_options.h"
#include "topics.h"

#include <brdfs/catalog/preset.h>
#include <brdfs/presets/preset_collection.h>
#include <jobs/common/option_words.h>

#include <CLI/CLI.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

using Words = std::vector<Word>;

using jobs::basisWords;
using jobs::modelWords;
using jobs::wordsOf;

Words presetWords() {
    Words words = wordsOf(brdfs::presets());
    for (const brdfs::CollectionEntry& collection : brdfs::presetCollections())
        words.push_back({std::string(collection.name), "a collection"});
    return words;
}

Words helpWords() {
    Words words = wordsOf(commands());
    for (const Topic& topic : topics()) words.push_back({topic.name, topic.help});
    return words;
}

// A row for one command stands before the row for all.
constexpr ValueRow valueRows[] = {
    {"batch", "MANIFEST", {nullptr, Syntax::word, Files::read, ""}},
    {"batch", "--output", {nullptr, Syntax::word, Files::folder}},
    {"choose", "--output", {nullptr, Syntax::word, Files::folder}},
    {"compare", "--output", {nullptr, Syntax::word, Files::folder}},
    {"convert", "--output", {nullptr, Syntax::word, Files::folder}},
    {"convert", "MORE", {nullptr, Syntax::brdf, Files::read}},
    {"completion", "--output", {nullptr, Syntax::word, Files::written, ""}},
    {"eval", "--output", {nullptr, Syntax::word, Files::written, ".csv"}},
    {"export", "--output", {nullptr, Syntax::word, Files::folder}},
    {"fit", "--all", {nullptr, Syntax::word, Files::readFolder}},
    {"help", "WORD", {helpWords}},
    {"illuminate", "--output", {nullptr, Syntax::word, Files::folder}},
    {"import", "FILE", {nullptr, Syntax::word, Files::read, ""}},
    {"info", "SPEC", {nullptr, Syntax::either, Files::read, ""}},
    {"irradiance", "SPEC", {nullptr, Syntax::light, Files::read, ""}},
    {"library", "--output", {nullptr, Syntax::word, Files::written, ".library"}},
    {"library", "INPUT", {nullptr, Syntax::brdf, Files::read, ""}},
    {"light", "SPEC", {nullptr, Syntax::light, Files::read, ""}},
    {"list", "TEXT", {presetWords}},
    {"manual", "--output", {nullptr, Syntax::word, Files::folder}},
    {"plan", "--output", {nullptr, Syntax::word, Files::folder}},
    {"plot", "--output", {nullptr, Syntax::word, Files::written}},
    {"render", "--output", {nullptr, Syntax::word, Files::written, ".png"}},
    {"report", "--output", {nullptr, Syntax::word, Files::folder}},
    {"sample", "--output", {nullptr, Syntax::word, Files::written, ".csv"}},
    {"stress", "--output", {nullptr, Syntax::word, Files::folder}},
    {"svbrdf", "DESCRIPTION", {nullptr, Syntax::word, Files::read, ".json"}},
    {"svbrdf", "--output", {nullptr, Syntax::word, Files::folder}},
    {"tradeoff", "--output", {nullptr, Syntax::word, Files::folder}},
    {"transfer", "--output", {nullptr, Syntax::word, Files::folder}},
    {"", "--compare-models", {modelWords, Syntax::sum}},
    {"", "--output", {nullptr, Syntax::word, Files::written, ".json"}},
    {"", "A", {nullptr, Syntax::brdf, Files::read, ""}},
    {"", "B", {nullptr, Syntax::brdf, Files::read, ""}},
    {"", "BASIS", {basisWords}},
    {"", "COEFFS", {nullptr, Syntax::brdf, Files::read, ""}},
    {"", "DATA", {nullptr, Syntax::brdf, Files::read, ""}},
    {"", "FILE", {nullptr, Syntax::word, Files::read, ""}},
    {"", "FROM", {basisWords}},
    {"", "IN", {nullptr, Syntax::brdf, Files::read, ""}},
    {"", "MODEL", {modelWords}},
    {"", "OUT", {nullptr, Syntax::word, Files::written, ""}},
    {"", "SCENE", {nullptr, Syntax::word, Files::read}},
    {"", "SPEC", {nullptr, Syntax::brdf, Files::read, ""}},
    {"", "TO", {basisWords}},
};

}  // namespace

std::span<const ValueRow> valueTable() {
    return valueRows;
}

namespace {

/// Null for what the type and the range of an option tell.
const Values* statedIn(const Values& values) {
    const bool plain = values.syntax == Syntax::word || values.syntax == Syntax::list ||
                       values.syntax == Syntax::numbers || values.syntax == Syntax::outgoing;
    return plain && !values.words && values.files == Files::none ? nullptr : &values;
}

}  // namespace

const jobs::OptionRow* findRow(const CLI::App& command, const CLI::Option& option) {
    const auto named = std::ranges::find(commands(), command.get_name(), &Command::name);
    if (named == commands().end() || !named->options) return nullptr;
    for (const auto rows : named->options())
        if (const jobs::OptionRow* row = rowOf(rows, option)) return row;
    return nullptr;
}

const Values* findValues(const CLI::App& command, const CLI::Option& option) {
    if (const jobs::OptionRow* row = findRow(command, option)) return statedIn(row->values);
    const auto row = std::ranges::find_if(valueRows, [&](const ValueRow& each) {
        return (each.command.empty() || each.command == command.get_name()) &&
               (each.option.starts_with("--")
                    ? option.check_lname(std::string(each.option.substr(2)))
                    : option.get_positional() && option.get_name(true, false) == each.option);
    });
    return row == std::end(valueRows) ? nullptr : &row->values;
}

bool isWritten(const CLI::App& command, const CLI::Option& option) {
    const Values* row = findValues(command, option);
    return row && (row->files == Files::written || row->files == Files::folder ||
                   row->files == Files::added || row->files == Files::addedFolder);
}

std::vector<std::string> choicesOf(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t open = type.find('{'), close = type.rfind('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

}  // namespace hshfit::cli
