#pragma once

// Rows of the arguments and options of commands, for the table of commands.

#include <jobs/common/option_row.h>

#include <span>
#include <vector>

namespace hshfit::cli {

using jobs::Files;
using jobs::Syntax;
using jobs::Values;
using jobs::Word;
using jobs::options::at;

/// An argument by its place, "SPEC", or an option that the command has beside the options of its
/// job, above all the output. A name in capitals is an argument by its place.
struct ArgumentRow {
    jobs::OptionRow row;
    bool required = false;
};
constexpr ArgumentRow required(std::string_view name, const jobs::Member& value,
                               std::string_view help, const Values& values = {}) {
    return {{.name = name, .value = value, .help = help, .values = values}, true};
}
constexpr ArgumentRow optional(std::string_view name, const jobs::Member& value,
                               std::string_view help, const Values& values = {}) {
    return {{.name = name, .value = value, .help = help, .values = values}};
}
/// -o, --output.
constexpr ArgumentRow optionalOutput(const jobs::Member& value, std::string_view help,
                                     const Values& values) {
    return {optional("output", value, help, values).row.orNamed("o")};
}
constexpr ArgumentRow requiredOutput(const jobs::Member& value, std::string_view help,
                                     const Values& values) {
    return {optionalOutput(value, help, values).row, true};
}

// Values that several commands take.
constexpr Values brdfRead = {.syntax = Syntax::brdf, .files = Files::read, .dash = ""};
constexpr Values lightRead = {.syntax = Syntax::light, .files = Files::read, .dash = ""};
constexpr Values jsonWritten = {.files = Files::written, .dash = ".json"};

/// All that a command takes.
struct CommandRows {
    std::span<const ArgumentRow> arguments;
    std::vector<std::span<const jobs::OptionRow>> options;  ///< of its jobs
};

CommandRows batchRows();
CommandRows chooseRows();
CommandRows compareRows();
CommandRows completionRows();
CommandRows convertRows();
CommandRows evalRows();
CommandRows exportRows();
CommandRows fitRows();
CommandRows gaussianRows();
CommandRows helpRows();
CommandRows illuminateRows();
CommandRows importRows();
CommandRows infoRows();
CommandRows irradianceRows();
CommandRows libraryRows();
CommandRows lightRows();
CommandRows listRows();
CommandRows ltcRows();
CommandRows manualRows();
CommandRows matrixRows();
CommandRows planRows();
CommandRows plotRows();
CommandRows projectRows();
CommandRows renderRows();
CommandRows reportRows();
CommandRows rotateRows();
CommandRows sampleRows();
CommandRows stressRows();
CommandRows svbrdfRows();
CommandRows tradeoffRows();
CommandRows transferRows();

}  // namespace hshfit::cli
