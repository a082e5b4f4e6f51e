#include "command.h"
#include "command_table.h"
#include "help_pages.h"
#include "option_values.h"
#include "standard_files.h"
#include "wording.h"

#include <brdfs/fit/solver_log.h>
#include <brdfs/spec.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstring>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace hshfit;

/// The unknown command, or the unknown option of a known command, with the nearest existing
/// name. "" for other errors.
std::string unknownWord(const CLI::App& app, int argc, char** argv) {
    const auto nearest = [](const std::string& word, const std::vector<std::string>& names) {
        const std::vector<std::string_view> known(names.begin(), names.end());
        return brdfs::suggestion(word, known);
    };
    const std::string first = argc > 1 ? argv[1] : "";
    if (first.empty() || first.starts_with('-')) return "";
    std::vector<std::string> names;
    const CLI::App* chosen = nullptr;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
        if (command->get_name() == first) chosen = command;
    }
    if (!chosen)
        return fmt::format("unknown command '{}'{}; known: {}", first, nearest(first, names),
                           fmt::join(names, ", "));
    names.clear();
    for (const CLI::Option* option : chosen->get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (int k = 2; k < argc; ++k) {
        const std::string word(argv[k], std::strcspn(argv[k], "="));
        if (word.size() > 2 && word.starts_with("--") &&
            std::ranges::find(names, word) == names.end())
            return fmt::format("{}: unknown option '{}'{}", first, word, nearest(word, names));
    }
    return "";
}

/// " project" of `hshfit project …`; "" where the first word is no command.
std::string chosenCommand(int argc, char** argv) {
    const std::string_view first = argc > 1 ? argv[1] : "";
    const bool known = std::ranges::any_of(
        cli::commands(), [&](const cli::Command& row) { return row.name == first; });
    return known && first != "help" ? fmt::format(" {}", first) : "";
}

/// Usage errors of ours and of CLI11 alike end in exit code 2 with one line.
int run(int argc, char** argv) {
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

    cli::refuseSpacedLists(app, {argv + std::min(argc, 1), argv + argc});
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        std::ostringstream text;
        const int code = app.exit(success, text, text);
        cli::printHelp(text.str());
        return code;
    } catch (const CLI::ParseError& error) {
        std::string message = unknownWord(app, argc, argv);
        if (message.empty()) message = error.what();
        std::ranges::replace(message, '\n', ' ');
        throw UsageError(message);
    }
    return globals.exitCode;
}

}  // namespace

int main(int argc, char** argv) {
    hshfit::cli::occupyStandardStreams();
    hshfit::removeTemporariesOnSignals();
    hshfit::setWording(hshfit::cli::optionWording());
    try {
        return run(argc, argv);
    } catch (const hshfit::UsageError& error) {
        hshfit::cli::printMessage(
            fmt::format("{}; see hshfit help{}", error.what(), chosenCommand(argc, argv)));
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
