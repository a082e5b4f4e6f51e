#include "command.h"

#include "code.h"
#include "command_table.h"
#include "outputs.h"
#include "page.h"
#include "standard_files.h"
#include "within.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <optional>

namespace hshfit::cli {

void addCommand(CLI::App& app, Globals& globals, const Command& row) {
    CLI::App& command = *app.add_subcommand(row.name, row.help);
    command.group(row.group);
    command.footer(row.example);
    command.add_flag("--json", globals.json, "Print a machine-readable answer to standard output");
    command.add_flag("--quiet", globals.quiet, "No progress and no notes on standard error");
    command.add_option("--threads", globals.threads, "Threads to use; 0: all cores")
        ->check(within(jobs::Bounds<int>{0, 4096}));
    if (!row.add) {
        command.allow_extras();
        command.callback([&row] { throw UsageError(notBuilt(row.name, *row.wing)); });
        return;
    }
    row.add(command, globals);
    addForce(command, globals);
    acceptStandardStreams(command);
}

namespace {

/// Writes to standard error. Failures are ignored, since nothing could report them.
void writeError(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

void writeOutput(std::string_view text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (!written || std::fflush(stdout) != 0) {
        throw OutputError(fmt::format("standard output: {}", std::strerror(errno)));
    }
}

}  // namespace

namespace {

void writeAnswer(const std::string& text) {
    isOutputTaken() ? writeError(withoutPathOfOutput(text)) : writeOutput(text);
}

}  // namespace

void printText(std::string_view given) {
    const std::string text = printableLines(given);
    const auto width = terminalWidth(isOutputTaken() ? Stream::error : Stream::output);
    writeAnswer(width ? folded(text, *width) : text);
}

void printCode(std::string_view code) {
    writeAnswer(printableLines(code));
}

void printJson(const nlohmann::ordered_json& document) {
    writeAnswer(printableLines(jsonText(document, 2) + "\n"));
}

namespace {

/// A line of at most 500 bytes with its beginning and its line feed.
std::string messageLine(std::string_view beginning, std::string_view message) {
    constexpr std::size_t longest = 500;
    const std::string text = withoutPathOfOutput(printable(message));
    return fmt::format("{}{}\n", beginning, shortened(text, longest - beginning.size() - 1));
}

}  // namespace

void printHelp(std::string_view text, Stream stream) {
    stream == Stream::output ? writeOutput(text) : writeError(text);
}

void printMessage(std::string_view message) noexcept {
    try {
        constexpr std::string_view name = "hshfit:";
        const std::string line = messageLine("hshfit: ", message);
        writeError(hasColour(Stream::error)
                       ? fmt::format("\x1b[1;31m{}\x1b[0m{}", name, line.substr(name.size()))
                       : line);
    } catch (const std::exception&) {
        writeError("hshfit: not enough memory\n");
    }
}

void endWithoutNumbers(Globals& globals, std::string_view message) {
    printMessage(message);
    globals.exitCode = static_cast<int>(ExitCode::numeric);
}

void occupyStandardStreams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
        // The other direction than the stream's: nothing can be read or written.
        ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
}

void closeOutput() {
    const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nothing < 0) return;
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
    ::close(nothing);
}

void note(const Globals& globals, std::string_view message) {
    if (!globals.quiet) writeError(messageLine("hshfit: ", message));
}

TerminalLine::TerminalLine(const Globals& globals)
    : shown_(!globals.quiet && isatty(STDERR_FILENO) != 0) {}

TerminalLine::~TerminalLine() {
    if (visible_) writeError("\r\x1b[K");
}

void TerminalLine::show(std::string_view text) {
    if (!shown_) return;
    visible_ = true;
    writeError(fmt::format("\r\x1b[K{}", printable(text)));
}

void printList(std::string_view message, const std::vector<std::string>& lines, std::size_t most) {
    printMessage(message);
    for (std::size_t i = 0; i < std::min(lines.size(), most); ++i)
        writeError(messageLine("  ", lines[i]));
    if (lines.size() > most) writeError(fmt::format("  and {} more\n", lines.size() - most));
}

struct Progress::State {
    using Clock = std::chrono::steady_clock;
    std::string what;
    std::optional<Clock::duration> silence;  ///< between lines that stay; none on a terminal
    std::mutex mutex;
    Clock::time_point start = Clock::now(), shown = start;
    bool visible = false;

    State(const std::string& text, std::optional<Clock::duration> between)
        : what(shortened(printable(text), 40)), silence(between) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { clear(); }

    void clear() {
        if (visible) writeError("\r\x1b[K");
        visible = false;
    }
    void update(std::size_t done, std::size_t total) {
        constexpr auto interval = std::chrono::milliseconds(200);
        const std::lock_guard lock(mutex);
        const auto now = Clock::now();
        if (now - shown < interval || done == 0) return;
        shown = now;
        const double seconds = std::chrono::duration<double>(now - start).count();
        const double share = static_cast<double>(done) / static_cast<double>(total);
        const double left = seconds * (1 - share) / share;
        if (silence) {
            // Between all parts of the work, which may be short.
            static std::mutex line;
            static Clock::time_point said = start;
            const std::lock_guard one(line);
            if (now - said < *silence) return;
            said = now;
            const std::string text = fmt::format("{}: {} of {} after {:.0f} s, {:.0f} s left", what,
                                                 done, total, seconds, left);
            writeError(messageLine("hshfit: ", text));
            return;
        }
        visible = true;
        writeError(fmt::format("\r\x1b[K{}  {}/{}  {:.3g}/s  {:.0f} s left", what, done, total,
                               static_cast<double>(done) / seconds, left));
    }
};

Progress::Progress(const Globals& globals, const std::string& what,
                   std::chrono::milliseconds silence) {
    if (globals.quiet) return;
    state_ = std::make_shared<State>(what, isatty(STDERR_FILENO)
                                               ? std::nullopt
                                               : std::optional<State::Clock::duration>(silence));
}

Progress::~Progress() {
    if (state_) state_->clear();
}

jobs::ProgressCall Progress::callback() {
    if (!state_) return {};
    return [state = state_](std::size_t done, std::size_t total) { state->update(done, total); };
}

jobs::Listener listenerFor(const Globals& globals) {
    return {
        .begin = [&globals](const std::string& part) { return Progress(globals, part).callback(); },
        .note = [&globals](const std::string& remark) { note(globals, remark); }};
}

nlohmann::ordered_json failuresJson(const std::vector<jobs::InputFailure>& failures) {
    auto rows = nlohmann::ordered_json::array();
    for (const jobs::InputFailure& failure : failures)
        rows.push_back({{"spec", failure.spec}, {"reason", failure.reason}});
    return rows;
}

void reportFailures(const std::vector<jobs::InputFailure>& failures, std::size_t inputs,
                    Globals& globals) {
    if (failures.empty()) return;
    printMessage(fmt::format("{} of {} inputs failed:", failures.size(), inputs));
    for (const jobs::InputFailure& failure : failures) {
        const bool named = failure.reason.find(failure.spec) != std::string::npos;
        writeError(
            messageLine("  ", named ? failure.reason : failure.spec + ": " + failure.reason));
    }
    globals.exitCode = static_cast<int>(jobs::codeOf(failures));
}

}  // namespace hshfit::cli
