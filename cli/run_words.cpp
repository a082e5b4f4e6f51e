#include "run_words.h"

#include "command.h"
#include "command_table.h"
#include "help_pages.h"
#include "option_values.h"
#include "outputs.h"
#include "standard_files.h"
#include "usage_errors.h"

#include <brdfs/fit/solver_log.h>
#include <hshfit/error.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <new>
#include <optional>
#include <sstream>

namespace hshfit::cli {
namespace {

/// Ends the parsing of a command whose files stand and are valid.
struct NothingToDo {};

/// Usage errors of ours and of CLI11 alike end in exit code 2 with one line.
int run(const std::vector<std::string>& words, Outputs outputs) {
    if (words.empty()) {
        printHelp(textOf(overviewPage(), columns(), hasColour(Stream::error)), Stream::error);
        return static_cast<int>(ExitCode::usage);
    }
    CLI::App app("hshfit: BRDFs as hemispherical-basis coefficients", "hshfit");
    usePagesForHelp(app);
    app.set_version_flag("--version", std::string("hshfit ") + version, "Print the version");
    app.require_subcommand(1);

    Globals globals;
    brdfs::takeSolverLog([&globals](const std::string& said) { note(globals, said); });
    std::optional<tbb::global_control> threads;
    app.parse_complete_callback([&] {
        if (globals.json && isOutputTaken())
            throw UsageError("--json: the answer and the file cannot both go to standard output");
        if (globals.threads > 0) {
            threads.emplace(tbb::global_control::max_allowed_parallelism, globals.threads);
        }
        setOutputRule({});
        takeKeptFiles();
        if (outputs == Outputs::kept)
            for (const CLI::App* command : app.get_subcommands())
                if (areOutputsKept(*command, globals)) throw NothingToDo();
    });
    for (const Command& row : commands()) addCommand(app, globals, row);

    refuseSpacedLists(app, words);
    try {
        app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const NothingToDo&) {
        return globals.exitCode;
    } catch (const CLI::Success& success) {
        std::ostringstream text;
        const int code = app.exit(success, text, text);
        printHelp(text.str());
        return code;
    } catch (const CLI::ParseError& error) {
        throw UsageError(usageMessage(app, error, words));
    }
    noteKeptFiles(globals);
    return globals.exitCode;
}

}  // namespace

int runWords(const std::vector<std::string>& words, Outputs outputs) noexcept {
    try {
        return run(words, outputs);
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
        printMessage(fmt::format("internal error: {}", error.what()));
        return 1;
    }
}

}  // namespace hshfit::cli
