#include "command.h"

#include <hshfit/error.h>
#include <hshfit/plan/plan_files.h>

#include <jobs/plan.h>

#include <CLI/CLI.hpp>

namespace hshfit::cli {
namespace {

struct PlanArguments {
    std::string scene, output;
    plan::PlanOptions options;
};

void runPlan(const PlanArguments& arguments, Globals& globals) {
    const plan::Plan result =
        jobs::planScene(arguments.scene, arguments.output, arguments.options, listenerFor(globals));
    printText(globals.json ? plan::planJson(result) : plan::planText(result));
    for (const plan::MaterialPlan& each : result.materials) {
        if (!each.accepted) globals.exitCode = static_cast<int>(ExitCode::numeric);
    }
}

}  // namespace

void addPlan(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<PlanArguments>();
    command.add_option("SCENE", arguments->scene, "Materials, lights, views and budget, as JSON")
        ->required();
    command
        .add_option("-o,--output", arguments->output,
                    "Folder for the coefficient files, plan.json, plan.csv and plan.html")
        ->required();
    command.add_option("--bases", arguments->options.bases, "Bases to try, orthonormal ones")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--max-order", arguments->options.maxOrder, "Bands to try")
        ->check(CLI::Range(1, 32))
        ->capture_default_str();
    command.add_flag("--by-time", arguments->options.byTime,
                     "Of the forms within the budget, the fastest instead of the smallest; what is "
                     "measured may differ between runs");
    command.callback([arguments, &globals] { runPlan(*arguments, globals); });
}

}  // namespace hshfit::cli
