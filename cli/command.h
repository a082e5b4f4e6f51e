#pragma once

#include "terminal.h"

#include <jobs/common/inputs.h>
#include <jobs/common/listener.h>

#include <nlohmann/json_fwd.hpp>

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace hshfit::cli {

struct Command;

/// Options that every command has, and the exit code of a command that ended without an exception.
struct Globals {
    bool json = false;
    bool quiet = false;
    bool force = false;  ///< of commands that write files
    int threads = 0;     ///< 0: all cores
    int exitCode = 0;
};

/// Adds a command with the global options, its own, and its example below the help.
void addCommand(CLI::App& app, Globals& globals, const Command& row);

/// Prints a JSON document to standard output. Throws OutputError if it cannot be written.
void printJson(const nlohmann::ordered_json& document);
/// Prints text to standard output, likewise, without control characters but line feeds and tabs; on
/// a terminal lines are broken at spaces where they reach its width.
void printText(std::string_view text);
/// Prints a page of help, colours included. Throws likewise.
void printHelp(std::string_view text, Stream stream = Stream::output);
/// Prints "hshfit: " and a message on one line of at most 500 bytes to standard error, printable,
/// its beginning in red on a terminal; a closed standard error is no error.
void printMessage(std::string_view message) noexcept;

/// Ends the command with the exit code of numbers that do not exist, and says which on standard
/// error.
void endWithoutNumbers(Globals& globals, std::string_view message);

/// Keeps closed standard streams from becoming the files that are opened next: reading and writing
/// them fails as if they were closed.
void occupyStandardStreams();

/// Nothing is printed from now on, on standard output or standard error.
void closeOutput();

/// A progress line on standard error: the task, the share done, the rate and the time left. Where
/// standard error is no terminal, such as the log of a batch, a line after every `silence`. Nothing
/// is shown with --quiet.
class Progress {
public:
    Progress(const Globals& globals, const std::string& what,
             std::chrono::milliseconds silence = std::chrono::minutes(1));
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// A callback for the options of library calls, thread-safe; empty if no line is shown.
    jobs::ProgressCall callback();

private:
    struct State;
    std::shared_ptr<State> state_;
};

/// One line on standard error that changes, while it lives. Nothing is shown with --quiet or if
/// standard error is no terminal.
class TerminalLine {
public:
    explicit TerminalLine(const Globals& globals);
    ~TerminalLine();
    TerminalLine(const TerminalLine&) = delete;
    TerminalLine& operator=(const TerminalLine&) = delete;

    bool isShown() const { return shown_; }
    void show(std::string_view text);

private:
    bool shown_, visible_ = false;
};

/// A message on standard error and lines below it, with --quiet too; beyond `most` lines their
/// number.
void printList(std::string_view message, const std::vector<std::string>& lines, std::size_t most);

/// A message on standard error, unless --quiet.
void note(const Globals& globals, std::string_view message);

/// Progress lines and notes of a job; none with --quiet.
jobs::Listener listenerFor(const Globals& globals);

/// [{"spec": …, "reason": …}]
nlohmann::ordered_json failuresJson(const std::vector<jobs::InputFailure>& failures);

/// Prints one line for each failure to standard error, with --quiet too, and sets the exit
/// code: 4 if all failures are numerical, else 3.
void reportFailures(const std::vector<jobs::InputFailure>& failures, std::size_t inputs,
                    Globals& globals);

}  // namespace hshfit::cli
