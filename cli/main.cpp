#include "command.h"

#include <hshfit/error.h>
#include <hshfit/output/atomic_file.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <new>
#include <optional>

namespace {

using namespace hshfit;

/// Usage errors of ours and of CLI11 alike end in exit code 2 with one line.
int run(int argc, char** argv) {
    CLI::App app("hshfit: BRDFs as hemispherical-basis coefficients", "hshfit");
    app.set_version_flag("--version", std::string("hshfit ") + version);
    app.require_subcommand(1);
    app.footer("hshfit COMMAND --help shows a command's options and an example.");

    cli::Globals globals;
    std::optional<tbb::global_control> threads;
    app.parse_complete_callback([&] {
        if (globals.threads > 0) {
            threads.emplace(tbb::global_control::max_allowed_parallelism, globals.threads);
        }
    });
    cli::addList(app, globals);
    cli::addInfo(app, globals);
    cli::addEval(app, globals);
    cli::addProject(app, globals);
    cli::addReport(app, globals);
    cli::addCompare(app, globals);
    cli::addConvert(app, globals);
    cli::addExport(app, globals);
    cli::addFit(app, globals);
    cli::addRender(app, globals);
    cli::addLtc(app, globals);
    cli::addGaussians(app, globals);
    cli::addTradeoff(app, globals);
    cli::addPlan(app, globals);
    cli::addStress(app, globals);
    cli::addImport(app, globals);

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        std::string message = error.what();
        for (char& c : message) c = c == '\n' ? ' ' : c;
        throw UsageError(message + "; see hshfit --help");
    }
    return globals.exitCode;
}

}  // namespace

int main(int argc, char** argv) {
    hshfit::removeTemporariesOnSignals();
    try {
        return run(argc, argv);
    } catch (const hshfit::Error& error) {
        fmt::print(stderr, "hshfit: {}\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "hshfit: not enough memory for what was asked\n");
        return static_cast<int>(hshfit::ExitCode::numeric);
    } catch (const std::exception& error) {
        fmt::print(stderr, "hshfit: internal error: {}\n", error.what());
        return 1;
    }
}
