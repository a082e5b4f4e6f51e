#pragma once

#include "manifest.h"

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// A command that an item of a batch may be.
struct BatchCommand {
    enum class Output { none, file, folder };
    std::string_view name;
    /// The result beside the answer, and its name within the item's folder; an empty name has to
    /// be stated in the manifest.
    Output output = Output::none;
    std::string_view outputName = {};
    bool comparesTwo = false;  ///< it takes a second input
    /// Cost of an ordinary item, in seconds; only ratios between commands count (costs.h).
    double cost = 1;
};

/// The program whose command lines are the items of a batch. Jobs know no words of it.
struct BatchProgram {
    std::string version;
    std::span<const BatchCommand> commands;
    /// Whether an option of a command, by its long name, names a file or a folder to be written.
    std::function<bool(const BatchCommand& command, const std::string& option)> writes;
    /// The words of an item's command line, with one thread, that writes into `folder`; with an
    /// empty one, the names alone of what it writes.
    std::function<std::vector<std::string>(const BatchItem& item, const std::string& folder)> words;
    /// One line about words that no command takes; empty where all is well. Nothing is run.
    std::function<std::string(const std::vector<std::string>& words)> mistake;
    /// Runs the words in this process, with the answer on standard output and one line of an error
    /// on standard error, and returns the exit code.
    std::function<int(const std::vector<std::string>& words)> run;
};

}  // namespace hshfit::jobs
