#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hshfit::cli {

/// Lets "-" stand for standard input in the options and arguments of a command that read one file,
/// and for standard output in those that write one (the rows of option_rows.h with a `dash`);
/// "exr:-" is standard output in the format of that extension.
void acceptStandardStreams(CLI::App& command);

/// Whether an option has taken standard output for a file: answers go to standard error then.
bool isOutputTaken();

/// A text in which the path that stands for standard output has its name.
std::string withoutPathOfOutput(const std::string& text);

}  // namespace hshfit::cli
