#pragma once

namespace CLI {
class App;
}

namespace hshfit::cli {

struct Globals;

/// Adds --force to a command that writes files, unless it has one.
void addForce(CLI::App& command, Globals& globals);

/// States the rule of the process for the files that the parsed command writes
/// (hshfit/files/output_rule.h, jobs/kept_outputs.h). If all of them exist and are valid, it prints
/// that and returns true: nothing is left to do, and the process ends with the exit code of the run
/// that made them. Throws OutputError for files that are refused, and UsageError where two options
/// write one file.
bool areOutputsKept(const CLI::App& command, Globals& globals);

/// Says which files stood with the bytes that the command would have written.
void noteKeptFiles(const Globals& globals);

}  // namespace hshfit::cli
