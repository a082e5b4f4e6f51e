#include "command.h"
#include "documents.h"

#include <brdfs/fit/gaussian_mixture_fit.h>
#include <brdfs/fit/gaussian_mixture_json.h>
#include <hshfit/accuracy/metrics.h>
#include <hshfit/files/atomic_file.h>

#include <jobs/source.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct GaussianArguments {
    std::string spec, output, kind = "sg", weight = "cosine", outgoing = "16", metrics;
    bool rgb = false;
    brdfs::GaussianFitOptions fit;
};

struct Totals {
    double meanError = 0, energyError = 0;
    std::size_t unsettled = 0;
};

Totals totalsOf(const brdfs::GaussianMixture& mixture) {
    Totals totals;
    const auto& elevations = mixture.content().elevations;
    for (const auto& elevation : elevations) {
        totals.meanError += elevation.error / static_cast<double>(elevations.size());
        totals.energyError =
            std::max(totals.energyError,
                     std::abs(elevation.fittedAlbedo - elevation.albedo) / elevation.albedo);
        totals.unsettled += elevation.converged ? 0 : 1;
    }
    return totals;
}

void runGaussians(GaussianArguments arguments, Globals& globals) {
    const auto metrics =
        arguments.metrics.empty() ? std::vector<const Metric*>() : selectMetrics(arguments.metrics);
    const OutgoingSet outgoing = OutgoingSet::parse(arguments.outgoing);
    const auto brdf = jobs::openBrdf(arguments.spec, arguments.rgb);
    arguments.fit.kind =
        arguments.kind == "sg" ? brdfs::GaussianKind::spherical : brdfs::GaussianKind::anisotropic;
    arguments.fit.cosine = arguments.weight == "cosine";
    Progress progress(globals, "gaussians");
    arguments.fit.progress = progress.callback();
    const brdfs::GaussianMixture mixture = brdfs::fitGaussians(*brdf, outgoing, arguments.fit);
    brdf->checkIntact();
    writeFile(arguments.output, brdfs::gaussianMixtureJson(mixture));

    std::vector<MetricValue> values;
    if (!metrics.empty()) values = compare(*brdf, mixture, outgoing, metrics);
    const Totals totals = totalsOf(mixture);
    if (totals.unsettled > 0)
        note(globals, fmt::format("{} of {} fits ended before they had settled", totals.unsettled,
                                  outgoing.size()));
    if (globals.json) {
        Json rows = Json::array();
        for (const MetricValue& value : values) rows.push_back(metricJson(value));
        printJson({{"format", "hshfit-gaussians-answer"},
                   {"version", 1},
                   {"brdf", brdf->name()},
                   {"output", arguments.output},
                   {"kind", arguments.kind},
                   {"lobes", arguments.fit.lobes},
                   {"outgoing", outgoing.spec()},
                   {"mean_error", totals.meanError},
                   {"largest_energy_error", totals.energyError},
                   {"unsettled", totals.unsettled},
                   {"metrics", std::move(rows)}});
        return;
    }
    std::string text = fmt::format(
        "{}: {} {} lobes for each of {} outgoing directions; relative error {:.4f}, albedo off by "
        "at most {:.2f} %\n",
        arguments.output, arguments.fit.lobes, arguments.kind, outgoing.size(), totals.meanError,
        100 * totals.energyError);
    for (const MetricValue& value : values) text += metricText(value);
    printText(text);
}

}  // namespace

void addGaussians(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<GaussianArguments>();
    command.add_option("SPEC", arguments->spec, "BRDF; isotropic")->required();
    command.add_option("-o,--output", arguments->output, "Mixture, .json")->required();
    command.add_option("--lobes", arguments->fit.lobes, "Gaussians for each outgoing direction")
        ->check(CLI::Range(1, 16))
        ->capture_default_str();
    command.add_option("--kind", arguments->kind, "sg (spherical) or asg (anisotropic)")
        ->check(CLI::IsMember({"sg", "asg"}))
        ->capture_default_str();
    command.add_option("--outgoing", arguments->outgoing, "N (elevations) or THETA,PHI in degrees")
        ->capture_default_str();
    command
        .add_option("--weight", arguments->weight,
                    "Least squares of f cos(theta_i) (cosine) or of f (none)")
        ->check(CLI::IsMember({"cosine", "none"}))
        ->capture_default_str();
    command.add_flag("--keep-energy", arguments->fit.keepEnergy,
                     "Scale amplitudes so that every albedo is kept");
    command.add_option("--metrics", arguments->metrics,
                       "Report the error: all, or names from hshfit list metrics");
    addRgb(command, arguments->rgb);
    command.callback([arguments, &globals] { runGaussians(*arguments, globals); });
}

}  // namespace hshfit::cli
