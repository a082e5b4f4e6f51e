#pragma once

#include "command_rows.h"

#include <hshfit/wings.h>

#include <optional>
#include <span>

namespace CLI {
class App;
}

namespace hshfit::cli {

struct Globals;

/// A command. The help, the shell completion, the index in docs/reference/commands.md and the law
/// tests all come from its row.
struct Command {
    const char* name;
    const char* group;    ///< heading in the help of the program
    const char* help;     ///< one line
    const char* file;     ///< the source in this folder
    const char* example;  ///< runs in a folder after the examples that write its inputs
    /// Adds the options and the function that runs the command; null in a wing that is not built.
    void (*add)(CLI::App& command, Globals& globals);
    CommandRows (*options)();
    std::optional<Wing> wing = std::nullopt;  ///< without one it is of the core
};

/// Every command, in the order in which messages list them.
std::span<const Command> commands();

}  // namespace hshfit::cli
