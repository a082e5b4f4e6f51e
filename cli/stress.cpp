#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <jobs/studies/stress.h>

#include <CLI/CLI.hpp>

namespace hshfit::cli {
namespace {

struct StressArguments {
    std::string output;
    jobs::StressOptions options;
};

void runStress(const StressArguments& arguments, const Globals& globals) {
    const stability::StressReport report =
        jobs::stress(arguments.output, arguments.options, listenerFor(globals));
    printText(globals.json ? stability::stressJson(report) : stability::stressMarkdown(report));
}

}  // namespace

OptionTables stressRows() {
    return {jobs::stressOptions().rows};
}

void addStress(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<StressArguments>();
    command.add_option("SPEC", arguments->options.lobes,
                       "Lobes to project (default: Lambert, and Phong, GGX and Ward to a mirror)");
    command.add_option("-o,--output", arguments->output,
                       "Folder for stress.json, stress.md and stress.csv, made if absent");
    addOptions(command, jobs::stressOptions(), arguments->options);
    command.callback([arguments, &globals] { runStress(*arguments, globals); });
}

}  // namespace hshfit::cli
