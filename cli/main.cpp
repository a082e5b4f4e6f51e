#include "command.h"
#include "command_table.h"
#include "help_pages.h"
#include "option_values.h"
#include "standard_files.h"
#include "usage_errors.h"
#include "wording.h"

#include <brdfs/fit/solver_log.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

/// Usage errors of ours and of CLI11 alike end in exit code 2 with one line.
int run(int argc, char** argv, const std::vector<std::string>& words) {
    if (argc == 1) {
        cli::printHelp(
            cli::textOf(cli::overviewPage(), cli::columns(), cli::hasColour(cli::Stream::error)),
            cli::Stream::error);
        return static_cast<int>(ExitCode::usage);
    }
    CLI::App app("hshfit: BRDFs as hemispherical-basis coefficients", "hshfit");
    cli::usePagesForHelp(app);
    app.set_version_flag("--version", std::string("hshfit ") + version, "Print the version");
    app.require_subcommand(1);

    cli::Globals globals;
    brdfs::takeSolverLog([&globals](const std::string& said) { cli::note(globals, said); });
    std::optional<tbb::global_control> threads;
    app.parse_complete_callback([&] {
        if (globals.json && cli::isOutputTaken())
            throw UsageError("--json: the answer and the file cannot both go to standard output");
        if (globals.threads > 0) {
            threads.emplace(tbb::global_control::max_allowed_parallelism, globals.threads);
        }
    });
    for (const cli::Command& row : cli::commands()) cli::addCommand(app, globals, row);

    cli::refuseSpacedLists(app, words);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        std::ostringstream text;
        const int code = app.exit(success, text, text);
        cli::printHelp(text.str());
        return code;
    } catch (const CLI::ParseError& error) {
        throw UsageError(cli::usageMessage(app, error, words));
    }
    return globals.exitCode;
}

}  // namespace

int main(int argc, char** argv) {
    hshfit::cli::occupyStandardStreams();
    hshfit::removeTemporariesOnSignals();
    hshfit::setWording(hshfit::cli::optionWording());
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    try {
        return run(argc, argv, words);
    } catch (const hshfit::UsageError& error) {
        hshfit::cli::printMessage(hshfit::cli::withHelp(error.what(), words));
        return static_cast<int>(error.code());
    } catch (const hshfit::Error& error) {
        hshfit::cli::printMessage(error.what());
        return static_cast<int>(error.code());
    } catch (const std::bad_alloc&) {
        hshfit::cli::printMessage("not enough memory for what was asked");
        return static_cast<int>(hshfit::ExitCode::numeric);
    } catch (const std::exception& error) {
        hshfit::cli::printMessage(fmt::format("internal error: {}", error.what()));
        return 1;
    }
}
