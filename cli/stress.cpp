#include "command.h"

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

void addStress(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<StressArguments>();
    command.add_option("SPEC", arguments->options.lobes,
                       "Lobes to project (default: Lambert, and Phong, GGX and Ward to a mirror)");
    command.add_option("--bases", arguments->options.bases, "all, or names from hshfit list bases")
        ->capture_default_str();
    command.add_option("--max-order", arguments->options.maxOrder, "Bands to look at")
        ->check(CLI::Range(2, 1000))
        ->capture_default_str();
    command.add_option("--trials", arguments->options.trials,
                       "Random projections over the catalog whose stated errors are tried "
                       "(default: 2000, or none if lobes are given)");
    command.add_option("--seed", arguments->options.seed, "Of the random projections")
        ->capture_default_str();
    command
        .add_option(
            "--of", arguments->options.of,
            "Models and formats whose random projections are tried, each as it is among all "
            "(default: all)")
        ->delimiter(',');
    command.add_option("-o,--output", arguments->output,
                       "Folder for stress.json, stress.md and stress.csv, made if absent");
    command.callback([arguments, &globals] { runStress(*arguments, globals); });
}

}  // namespace hshfit::cli
