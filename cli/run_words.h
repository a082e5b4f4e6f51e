#pragma once

#include <string>
#include <vector>

namespace hshfit::cli {

/// Runs a command line, `words` after the name of the program: the answer on standard output, one
/// line for an error on standard error. Returns the exit code and throws nothing.
int runWords(const std::vector<std::string>& words) noexcept;

}  // namespace hshfit::cli
