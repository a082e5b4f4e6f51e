#pragma once

#include <string>
#include <vector>

namespace hshfit::cli {

/// Runs a command line, `words` after the name of the program: the answer on standard output, one
/// line for an error on standard error. Returns the exit code and throws nothing. Files that stand
/// are kept or refused (outputs.h); with `Outputs::replaced` they are replaced.
enum class Outputs { kept, replaced };
int runWords(const std::vector<std::string>& words, Outputs outputs = Outputs::kept) noexcept;

/// Makes an exception that nothing catches, such as one of a thread of oneTBB that could start no
/// other, end the process as an error of runWords does: with one line, an exit code and no
/// temporary. For `main` to call once.
void endUncaughtInOneLine();

}  // namespace hshfit::cli
