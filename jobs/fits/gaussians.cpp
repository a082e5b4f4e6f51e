#include "gaussians.h"

#include <jobs/common/metric_json.h>
#include <jobs/source/source.h>

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <brdfs/fit/gaussian_mixture_json.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace hshfit::jobs {
namespace {

void addTotals(FittedGaussians& result) {
    const auto& elevations = result.mixture.content().elevations;
    for (const auto& elevation : elevations) {
        result.meanError += elevation.error / static_cast<double>(elevations.size());
        result.largestEnergyError =
            std::max(result.largestEnergyError,
                     std::abs(elevation.fittedAlbedo - elevation.albedo) / elevation.albedo);
        result.unsettled += elevation.converged ? 0 : 1;
    }
}

}  // namespace

FittedGaussians fitGaussians(const std::string& spec, const std::string& output,
                             const GaussianOptions& options, const Listener& listener) {
    const auto metrics =
        options.metrics.empty() ? std::vector<const Metric*>() : selectMetrics(options.metrics);
    const OutgoingSet outgoing = OutgoingSet::parse(options.outgoing);
    const auto brdf = openBrdf(spec, options.rgb);
    brdfs::GaussianFitOptions how = options.fit;
    how.progress = listener.part("gaussians");
    FittedGaussians result{.brdf = brdf->name(),
                           .mixture = brdfs::fitGaussians(*brdf, outgoing, how),
                           .outgoing = outgoing};
    brdf->checkIntact();
    writeFile(output, brdfs::gaussianMixtureJson(result.mixture));
    if (!metrics.empty()) result.metrics = compare(*brdf, result.mixture, outgoing, metrics);
    addTotals(result);
    if (result.unsettled > 0)
        listener.say(fmt::format("{} of {} fits ended before they had settled", result.unsettled,
                                 outgoing.size()));
    return result;
}

void parseGaussians(const std::string& kind, const std::string& weight,
                    brdfs::GaussianFitOptions& options) {
    if (kind != "sg" && kind != "asg")
        throw UsageError(fmt::format("unknown kind '{}'; known: sg, asg", kind));
    if (weight != "cosine" && weight != "none")
        throw UsageError(fmt::format("unknown weight '{}'; known: cosine, none", weight));
    options.kind = kind == "sg" ? brdfs::GaussianKind::spherical : brdfs::GaussianKind::anisotropic;
    options.cosine = weight == "cosine";
}

nlohmann::ordered_json gaussiansJson(const FittedGaussians& fitted, const std::string& output,
                                     const brdfs::GaussianFitOptions& options) {
    return {{"format", "hshfit-gaussians-answer"},
            {"version", 1},
            {"brdf", fitted.brdf},
            {"output", output},
            {"kind", options.kind == brdfs::GaussianKind::spherical ? "sg" : "asg"},
            {"lobes", options.lobes},
            {"outgoing", fitted.outgoing.spec()},
            {"mean_error", fitted.meanError},
            {"largest_energy_error", fitted.largestEnergyError},
            {"unsettled", fitted.unsettled},
            {"metrics", metricValuesJson(fitted.metrics)}};
}

}  // namespace hshfit::jobs
