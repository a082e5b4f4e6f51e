#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace hshfit::cli {

/// One line for an error of CLI11, with the nearest known name in the place of an unknown command,
/// option or choice. `words` follow the name of the program.
std::string usageMessage(const CLI::App& app, const CLI::Error& error,
                         const std::vector<std::string>& words);

/// Throws UsageError for an option, or the name of a file to write, that is an empty text, as an
/// unset variable of a shell is (-o "$OUT"). Other arguments are seen to where they are read.
void refuseEmptyValues(const CLI::App& command);

/// The message and the command line that shows the help of the command among `words`.
std::string withHelp(const std::string& message, const std::vector<std::string>& words);

}  // namespace hshfit::cli
