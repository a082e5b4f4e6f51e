#pragma once

#include <jobs/common/option_row.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace hshfit::cli {

using jobs::Files;
using jobs::Syntax;
using jobs::Values;
using jobs::Word;

/// The values of an argument by its place, or of an option that has no row of its job
/// (jobs/common/option_row.h). Completion comes from these rows, and from the choices and ranges
/// that options state themselves.
struct ValueRow {
    std::string_view command;  ///< empty: every command that has the option
    std::string_view option;   ///< "--basis", or the name of an argument
    Values values = {};
};

std::span<const ValueRow> valueTable();

/// The row of an option of a command; null if it has none.
const jobs::OptionRow* findRow(const CLI::App& command, const CLI::Option& option);

/// The values of an option of a command; null if no row states them.
const Values* findValues(const CLI::App& command, const CLI::Option& option);

/// Whether the option names a file or a folder that the command writes.
bool isWritten(const CLI::App& command, const CLI::Option& option);

/// The choices that the option checks its value against (CLI::IsMember); none if it does not.
std::vector<std::string> choicesOf(const CLI::Option& option);

}  // namespace hshfit::cli
