#pragma once

#include <string_view>

namespace hshfit::cli {

/// Prints lines of code as printText (command.h), each as it is, so that they may be copied from a
/// terminal of any width.
void printCode(std::string_view code);

}  // namespace hshfit::cli
