#include "gaussians.h"

#include <jobs/common/enum_words.h>
#include <jobs/common/json_output.h>
#include <jobs/common/metric_json.h>
#include <jobs/common/option_words.h>
#include <jobs/common/shared_options.h>
#include <jobs/source/better_form.h>
#include <jobs/source/picture.h>
#include <jobs/source/source.h>

#include <hshfit/files/atomic_file.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/spelling.h>

#include <brdfs/fit/gaussian_mixture_json.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::jobs {
namespace {

using options::at;
using options::spelled;

constexpr EnumWord gaussianKinds[] = {{"sg", "spherical"}, {"asg", "anisotropic"}};
using GaussianKinds = EnumWords<gaussianKinds, brdfs::GaussianKind>;

/// The losses of values of f; that of pictures asks for lights.
std::vector<Word> gaussianLosses() {
    std::vector<Word> words;
    for (const brdfs::Loss& loss : brdfs::losses())
        if (loss.kind != brdfs::Loss::Kind::picture)
            words.push_back({std::string(loss.name), std::string(loss.help)});
    return words;
}

constexpr OptionRow gaussianRows[] = {
    OptionRow{"lobes", at<&GaussianOptions::fit, &brdfs::GaussianFitOptions::lobes>,
              "Gaussians for each outgoing direction"}
        .within(Bounds<int>{1, 16}),
    OptionRow{"kind",
              spelled<GaussianKinds::parse, GaussianKinds::name, &GaussianOptions::fit,
                      &brdfs::GaussianFitOptions::kind>,
              "sg (spherical) or asg (anisotropic)"}
        .takes({.words = GaussianKinds::words, .complete = true}),
    OptionRow{"outgoing", at<&GaussianOptions::outgoing>, "N (elevations) or THETA,PHI in degrees"}
        .takes({.syntax = Syntax::outgoing}),
    OptionRow{"loss", at<&GaussianOptions::loss>,
              "Squares are of f (l2), f cos(theta_i) (cosine), log, log-relative or cube-root"}
        .takes({.words = gaussianLosses, .complete = true}),
    OptionRow{"keep-energy", at<&GaussianOptions::fit, &brdfs::GaussianFitOptions::keepEnergy>,
              "Scale amplitudes so that every albedo is kept"},
    OptionRow{"metrics", at<&GaussianOptions::metrics>,
              "Report the error: all, or names of metrics"}
        .takes({metricLists, Syntax::list}),
    rgbRow(at<&GaussianOptions::rgb>),
};

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

/// The picture error, and whether the mixture is poor. Forms of coefficients have the advice.
void judge(const Brdf& brdf, FittedGaussians& result) {
    const bool sphere = result.outgoing.map != OutgoingSet::Map::direction;
    if (sphere) result.picture = pictureErrorOf(brdf, result.mixture);
    const auto reason = poorReason(1 - result.meanError * result.meanError, result.picture);
    if (!reason) return;
    CoefficientHead head;
    head.source = result.brdf;
    if (!sphere) head.outgoing = result.outgoing;
    const Advice advice = adviceBeside(head, nullptr, brdf, "coefficients.json");
    result.poor = Poor{*reason, advice.better, advice.toTry};
}

}  // namespace

OptionRows<GaussianOptions> gaussianOptions() {
    return {gaussianRows};
}

FittedGaussians fitGaussians(const std::string& spec, const std::string& output,
                             const GaussianOptions& options, const Listener& listener) {
    requireJsonName(output, "mixtures of Gaussians");
    const auto metrics =
        options.metrics.empty() ? std::vector<const Metric*>() : selectMetrics(options.metrics);
    const OutgoingSet outgoing = OutgoingSet::parse(options.outgoing);
    const auto brdf = openBrdf(spec, options.rgb);
    brdfs::GaussianFitOptions how = options.fit;
    how.loss = brdfs::findLoss(options.loss).kind;
    how.progress = listener.part("gaussians");
    FittedGaussians result{.brdf = brdf->name(),
                           .mixture = brdfs::fitGaussians(*brdf, outgoing, how),
                           .outgoing = outgoing};
    brdf->checkIntact();
    writeFile(output, brdfs::gaussianMixtureJson(result.mixture));
    if (!metrics.empty()) result.metrics = compare(*brdf, result.mixture, outgoing, metrics);
    addTotals(result);
    judge(*brdf, result);
    if (result.unsettled > 0)
        listener.say(fmt::format("{} of {} fits ended before they had settled", result.unsettled,
                                 outgoing.size()));
    return result;
}

nlohmann::ordered_json gaussiansJson(const FittedGaussians& fitted, const std::string& output,
                                     const GaussianOptions& options) {
    nlohmann::ordered_json json = {{"format", "hshfit-gaussians-answer"},
                                   {"version", 1},
                                   {"brdf", fitted.brdf},
                                   {"output", output},
                                   {"kind", GaussianKinds::name(options.fit.kind)},
                                   {"lobes", options.fit.lobes},
                                   {"outgoing", fitted.outgoing.spec()},
                                   {"mean_error", fitted.meanError},
                                   {"largest_energy_error", fitted.largestEnergyError},
                                   {"unsettled", fitted.unsettled},
                                   {"metrics", metricValuesJson(fitted.metrics)}};
    if (fitted.poor) json["poor"] = poorJson(*fitted.poor);
    if (fitted.picture) json["picture"] = pictureErrorJson(*fitted.picture);
    return json;
}

}  // namespace hshfit::jobs
