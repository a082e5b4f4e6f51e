#pragma once

#include "command_rows.h"

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace hshfit::cli {

/// The row of an argument or option of a command; null for options that every command has.
const jobs::OptionRow* findRow(const CLI::App& command, const CLI::Option& option);

/// The values of an argument or option; null where its type and its range state them.
const Values* findValues(const CLI::App& command, const CLI::Option& option);

/// Whether the option names a file or a folder that the command writes.
bool isWritten(const CLI::App& command, const CLI::Option& option);

/// The choices that the option checks its value against (CLI::IsMember); none if it does not.
std::vector<std::string> choicesOf(const CLI::Option& option);

}  // namespace hshfit::cli
