#include "run_words.h"

#include "command.h"
#include "command_table.h"
#include "help_pages.h"
#include "option_rows.h"
#include "option_values.h"
#include "outputs.h"
#include "standard_files.h"
#include "usage_errors.h"

#include <brdfs/fit/solver_log.h>
#include <hshfit/error.h>
#include <hshfit/files/interruption.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/version.h>
#include <jobs/source/map_facts.h>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <system_error>

#include <unistd.h>

namespace hshfit::cli {
namespace {

/// Ends the parsing of a command whose files stand and are valid.
struct NothingToDo {};

/// Says of each BRDF that is a map of materials, and of no texel in words, that it is one texel.
/// `info` describes the map, and `export` takes all of it.
void noteTexels(const CLI::App& command, const Globals& globals) {
    if (command.get_name() == "info" || command.get_name() == "export") return;
    for (const CLI::Option* option : command.get_options()) {
        const Values* row = option->count() > 0 ? findValues(command, *option) : nullptr;
        if (!row || row->syntax != Syntax::brdf || row->files != Files::read) continue;
        for (const std::string& spec : option->results()) {
            std::string remark;
            try {
                remark = jobs::texelRemark(spec);
            } catch (const Error&) {
                continue;  // of an input, which the command itself reports
            }
            if (!remark.empty()) note(globals, fmt::format("{}: {}", spec, remark));
        }
    }
}

/// Usage errors of ours and of CLI11 alike end in exit code 2 with one line.
int run(const std::vector<std::string>& words, Outputs outputs) {
    if (words.empty()) {
        printHelp(textOf(overviewPage(), columns(), hasColour(Stream::error)), Stream::error);
        return static_cast<int>(ExitCode::usage);
    }
    CLI::App app("hshfit: BRDFs as hemispherical-basis coefficients", "hshfit");
    usePagesForHelp(app);
    app.set_version_flag("-V,--version", std::string("hshfit ") + version, "Print the version");
    app.require_subcommand(1);

    Globals globals;
    // A start may fail while others succeed. Results state whether they have settled.
    brdfs::takeSolverLog([](const std::string&) {});
    std::unique_ptr<tbb::global_control> threadsOfItem;
    app.parse_complete_callback([&] {
        if (globals.json && isOutputTaken())
            throw UsageError("--json: the answer and the file cannot both go to standard output");
        for (const CLI::App* command : app.get_subcommands()) refuseEmptyValues(*command);
        if (globals.threads > 0) {
            auto limit = std::make_unique<tbb::global_control>(
                tbb::global_control::max_allowed_parallelism, globals.threads);
            // oneTBB starts threads where a limit ends, which is too much for the end of a process.
            if (outputs == Outputs::replaced)
                threadsOfItem = std::move(limit);
            else
                limit.release();
        }
        setOutputRule({});
        takeKeptFiles();
        if (outputs == Outputs::kept)
            for (const CLI::App* command : app.get_subcommands())
                if (areOutputsKept(*command, globals)) throw NothingToDo();
        for (const CLI::App* command : app.get_subcommands()) noteTexels(*command, globals);
    });
    for (const Command& row : commands()) addCommand(app, globals, row);

    refuseSpacedLists(app, words);
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const NothingToDo&) {
        return globals.exitCode;
    } catch (const CLI::Success& success) {
        std::ostringstream text;
        text.exceptions(std::ios::badbit);
        const int code = app.exit(success, text, text);
        printHelp(text.str());
        return code;
    } catch (const CLI::ParseError& error) {
        throw UsageError(usageMessage(app, error, words));
    }
    noteKeptFiles(globals);
    return globals.exitCode;
}

/// Whether the system refuses a thread, in the words of the C++ library or of oneTBB.
bool refusesThread(const std::exception& error) {
    const auto* system = dynamic_cast<const std::system_error*>(&error);
    return (system && system->code() == std::errc::resource_unavailable_try_again) ||
           std::string_view(error.what()).starts_with("pthread_");
}

/// Prints a line for the exception that is being handled, and returns its exit code.
int reported(const std::vector<std::string>& words) noexcept try {
    throw;
} catch (const UsageError& error) {
    printMessage(withHelp(error.what(), words));
    return static_cast<int>(error.code());
} catch (const Error& error) {
    printMessage(error.what());
    return static_cast<int>(error.code());
} catch (const std::bad_alloc&) {
    printMessage("not enough memory for what was asked");
    return static_cast<int>(ExitCode::numeric);
} catch (const std::exception& error) {
    if (refusesThread(error)) {
        printMessage("the system starts no more threads; --threads 1 does with the first one");
        return static_cast<int>(ExitCode::numeric);
    }
    printMessage(fmt::format("internal error: {}", error.what()));
    return 1;
} catch (...) {
    printMessage("internal error");
    return 1;
}

}  // namespace

int runWords(const std::vector<std::string>& words, Outputs outputs) noexcept {
    try {
        return run(words, outputs);
    } catch (...) {
        return reported(words);
    }
}

void endUncaughtInOneLine() {
    std::set_terminate([] {
        static std::atomic<bool> ending = false;
        if (ending.exchange(true)) {
            for (;;) ::pause();
        }
        if (std::current_exception()) removeTracesAndExit(reported({}));
        printMessage("internal error");
        removeTracesAndExit(1);
    });
}

}  // namespace hshfit::cli
