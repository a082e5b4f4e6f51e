#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "job_options.h"

#include <hshfit/percent.h>

#include <jobs/fits/gaussians.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct GaussianArguments {
    std::string spec, output;
    jobs::GaussianOptions options;
};

void runGaussians(const GaussianArguments& arguments, const Globals& globals) {
    const jobs::FittedGaussians fitted = jobs::fitGaussians(
        arguments.spec, arguments.output, arguments.options, listenerFor(globals));
    const Json answer = jobs::gaussiansJson(fitted, arguments.output, arguments.options);
    if (fitted.poor) note(globals, fitted.poor->line());
    if (globals.json) return printJson(answer);
    std::string text = fmt::format(
        "{}: {} {} lobes for each of {} outgoing directions; relative error {:.4f}, albedo off by "
        "at most {}\n",
        arguments.output, answer["lobes"].get<int>(), answer["kind"].get<std::string>(),
        fitted.outgoing.size(), fitted.meanError, percent(fitted.largestEnergyError));
    if (fitted.picture) text += "  " + summaryOf(*fitted.picture) + "\n";
    for (const MetricValue& value : fitted.metrics) text += metricText(value);
    printText(text);
}

constexpr ArgumentRow gaussiansArguments[] = {
    required("SPEC", at<&GaussianArguments::spec>, "BRDF; isotropic", brdfRead),
    requiredOutput(at<&GaussianArguments::output>, "Mixture, .json", jsonWritten),
};

}  // namespace

CommandRows gaussianRows() {
    return {gaussiansArguments, {jobs::gaussianOptions().rows}};
}

void addGaussians(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<GaussianArguments>();
    addArguments(command, gaussiansArguments, *arguments);
    addOptions(command, jobs::gaussianOptions(), arguments->options);
    command.callback([arguments, &globals] { runGaussians(*arguments, globals); });
}

}  // namespace hshfit::cli
