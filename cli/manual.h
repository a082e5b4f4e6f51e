#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hshfit::cli {

struct Command;
struct Topic;

// Pages for man(1) in the macros of groff_man(7), from the pages of the help.

std::string programManual(const CLI::App& program);
std::string commandManual(const Command& row, const CLI::App& command);
std::string topicManual(const Topic& topic);

}  // namespace hshfit::cli
