#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <hshfit/error.h>
#include <hshfit/plan/plan_files.h>

#include <jobs/scenes/plan.h>
#include <jobs/scenes/plan_lighting.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

struct PlanArguments {
    std::string scene, output;
    plan::PlanOptions options;
    jobs::PlanLightingOptions lighting;
};

std::string plannedLightingText(const std::vector<jobs::PlannedLighting>& planned) {
    std::string out;
    for (const jobs::PlannedLighting& row : planned) {
        if (!row.choice) {
            out += fmt::format("{}: lighting: {}\n", row.material,
                               row.refused.empty() ? "no model is within the budget" : row.refused);
            continue;
        }
        const jobs::LightingError& error = row.choice->error;
        out += fmt::format(
            "{}: lighting by {}, {}: {} + {} bytes, {:.0f} ns a point, error {:.4f} of {:.4f}\n",
            row.material, error.model, row.choice->settings, error.bytes, error.lightBytes,
            error.nanoseconds, error.difference.relativeL2, row.budget);
    }
    return out;
}

void runPlan(const PlanArguments& arguments, Globals& globals) {
    const plan::Plan result =
        jobs::planScene(arguments.scene, arguments.output, arguments.options, listenerFor(globals));
    std::vector<jobs::PlannedLighting> lighting;
    const std::string& models = arguments.lighting.models;
    if (!models.empty())
        lighting = jobs::planLighting(result.scene, models, arguments.options.byTime,
                                      listenerFor(globals));
    if (globals.json && !models.empty()) {
        auto document = nlohmann::ordered_json::parse(plan::planJson(result));
        document["lighting"] = jobs::plannedLightingJson(lighting);
        printJson(document);
    } else {
        printText(globals.json ? plan::planJson(result)
                               : plan::planText(result) + plannedLightingText(lighting));
    }
    for (const plan::MaterialPlan& each : result.materials) {
        if (!each.accepted)
            endWithoutNumbers(globals, fmt::format("{}: {}", each.material.name, each.refused));
    }
}

constexpr ArgumentRow planArguments[] = {
    required("SCENE", at<&PlanArguments::scene>, "Materials, lights, views and budget, as JSON",
             {.files = Files::read}),
    requiredOutput(at<&PlanArguments::output>,
                   "Folder for the coefficient files, plan.json, plan.csv and plan.html",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows planRows() {
    return {planArguments, {jobs::planOptions().rows, jobs::planLightingOptions().rows}};
}

void addPlan(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<PlanArguments>();
    addArguments(command, planArguments, *arguments);
    addOptions(command, jobs::planOptions(), arguments->options);
    addOptions(command, jobs::planLightingOptions(), arguments->lighting);
    command.callback([arguments, &globals] { runPlan(*arguments, globals); });
}

}  // namespace hshfit::cli
