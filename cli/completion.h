#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hshfit::cli {

/// A script that completes commands and their options in bash.
std::string bashCompletion(const CLI::App& app);

}  // namespace hshfit::cli
