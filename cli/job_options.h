#pragma once

#include "command_rows.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace hshfit::cli {

/// Adds the arguments of a command, whose values go to members of `arguments`. An option that one
/// of them needs has to be there already.
void addArguments(CLI::App& command, std::span<const ArgumentRow> rows, void* arguments,
                  const std::type_info& type);
template <class Arguments>
void addArguments(CLI::App& command, std::span<const ArgumentRow> rows, Arguments& arguments) {
    addArguments(command, rows, &arguments, typeid(Arguments));
}

/// Adds the options of a job; `options` has the defaults, and takes what is given. `group` is a
/// heading in the help; none: among the others.
void addOptions(CLI::App& command, const std::vector<jobs::BoundOption>& options,
                const std::string& group);
template <class Options>
void addOptions(CLI::App& command, jobs::OptionRows<Options> rows, Options& options,
                const std::string& group = {}) {
    addOptions(command, boundOptions(rows, options), group);
}

/// Whether an option of the command line stands for this row.
bool isOf(const CLI::Option& option, const jobs::OptionRow& row);
/// The row that an option of the command line stands for; null if it is none of these.
const jobs::OptionRow* rowOf(std::span<const jobs::OptionRow> rows, const CLI::Option& option);

/// An option that is given, "--basis", and its row.
struct GivenOption {
    std::string name;
    const jobs::OptionRow* row;
};
/// The first option given that is not for the kinds `inputs` (OptionRow::inputs).
std::optional<GivenOption> misplacedOption(const CLI::App& command,
                                           std::span<const jobs::OptionRow> rows, unsigned inputs);

}  // namespace hshfit::cli
