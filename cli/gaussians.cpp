#include "command.h"
#include "documents.h"

#include <jobs/fits/gaussians.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

struct GaussianArguments {
    std::string spec, output, kind = "sg", weight = "cosine";
    jobs::GaussianOptions options;
};

void runGaussians(GaussianArguments& arguments, const Globals& globals) {
    brdfs::GaussianFitOptions& fit = arguments.options.fit;
    jobs::parseGaussians(arguments.kind, arguments.weight, fit);
    const jobs::FittedGaussians fitted = jobs::fitGaussians(
        arguments.spec, arguments.output, arguments.options, listenerFor(globals));
    if (globals.json) return printJson(jobs::gaussiansJson(fitted, arguments.output, fit));
    std::string text = fmt::format(
        "{}: {} {} lobes for each of {} outgoing directions; relative error {:.4f}, albedo off by "
        "at most {:.2f} %\n",
        arguments.output, fit.lobes, arguments.kind, fitted.outgoing.size(), fitted.meanError,
        100 * fitted.largestEnergyError);
    for (const MetricValue& value : fitted.metrics) text += metricText(value);
    printText(text);
}

}  // namespace

void addGaussians(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<GaussianArguments>();
    command.add_option("SPEC", arguments->spec, "BRDF; isotropic")->required();
    command.add_option("-o,--output", arguments->output, "Mixture, .json")->required();
    command
        .add_option("--lobes", arguments->options.fit.lobes,
                    "Gaussians for each outgoing direction")
        ->check(CLI::Range(1, 16))
        ->capture_default_str();
    command.add_option("--kind", arguments->kind, "sg (spherical) or asg (anisotropic)")
        ->check(CLI::IsMember({"sg", "asg"}))
        ->capture_default_str();
    command
        .add_option("--outgoing", arguments->options.outgoing,
                    "N (elevations) or THETA,PHI in degrees")
        ->capture_default_str();
    command
        .add_option("--weight", arguments->weight,
                    "Least squares of f cos(theta_i) (cosine) or of f (none)")
        ->check(CLI::IsMember({"cosine", "none"}))
        ->capture_default_str();
    command.add_flag("--keep-energy", arguments->options.fit.keepEnergy,
                     "Scale amplitudes so that every albedo is kept");
    command.add_option("--metrics", arguments->options.metrics,
                       "Report the error: all, or names from hshfit list metrics");
    addRgb(command, arguments->options.rgb);
    command.callback([arguments, &globals] { runGaussians(*arguments, globals); });
}

}  // namespace hshfit::cli
