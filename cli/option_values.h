#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hshfit::cli {

/// Throws UsageError where the values of one option that takes them with commas are given as words
/// of their own ("--orders 3 5"), with what was meant ("--orders 3,5"). `words` follow the name of
/// the program. A word that is a file is taken for a file.
void refuseSpacedLists(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace hshfit::cli
