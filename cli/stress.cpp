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

constexpr ArgumentRow stressArguments[] = {
    optional("SPEC", at<&StressArguments::options, &jobs::StressOptions::lobes>,
             "Lobes to project (default: Lambert, and Phong, GGX and Ward to a mirror)", brdfRead),
    optionalOutput(at<&StressArguments::output>,
                   "Folder for stress.json, stress.md and stress.csv, made if absent",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows stressRows() {
    return {stressArguments, {jobs::stressOptions().rows}};
}

void addStress(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<StressArguments>();
    addArguments(command, stressArguments, *arguments);
    addOptions(command, jobs::stressOptions(), arguments->options);
    command.callback([arguments, &globals] { runStress(*arguments, globals); });
}

}  // namespace hshfit::cli
