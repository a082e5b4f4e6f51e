#include "compare.h"

#include <jobs/source/picture.h>
#include <jobs/source/source.h>

#include <brdfs/measured/mueller.h>
#include <brdfs/measured/scattered/scattered.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

namespace hshfit::jobs {
namespace {

OutgoingSet outgoingOf(const CompareOptions& options, const Brdf& a, const Brdf& b) {
    if (options.outgoing.empty()) {
        for (const Brdf* brdf : {&b, &a}) {
            if (const auto* r = dynamic_cast<const Reconstruction*>(brdf)) {
                return r->coefficients().outgoing;
            }
            const auto* r = dynamic_cast<const RepresentedBrdf*>(brdf);
            if (r && r->representation().kind() == Representation::Kind::outgoing) {
                return r->representation().head.outgoing;
            }
        }
    }
    return outgoingOrDefault(options.outgoing, a.laws().isotropic ? b : a);
}

/// The page, whose table holds every metric, including those that were not asked for, and figures
/// for print.
void writeFiles(const Brdf& a, const Brdf& b, const std::string& folder,
                const CompareOptions& options, const Listener& listener, Compared& compared) {
    requireReflection(a, "a page with its lit spheres");
    brdfs::requireReflectance(a, "a page with its lit spheres");
    const auto filesIn = [](const std::string& name) {
        return name.empty() ? nullptr
                            : std::make_unique<FileSet>(name, true, FileSet::Above::require);
    };
    const auto page = filesIn(folder),
               figures = filesIn(options.figures ? options.figures->folder : "");
    ComparisonOptions how{.outgoing = compared.outgoing};
    how.picture = compared.picture;
    if (options.metrics == "all") how.metrics = compared.metrics;
    how.progress = how.sphere.progress = listener.part("report");
    const Comparison comparison = makeComparison(a, b, how);
    std::optional<std::string> undrawn;
    if (page) {
        AddedComparison added = addComparison(comparison, *page);
        compared.files = std::move(added.names);
        undrawn = std::move(added.undrawn);
    }
    if (figures) {
        compared.figures =
            addComparisonFigures(comparison, a, b, options.sigma, *options.figures, *figures);
        if (compared.figures.undrawn) undrawn = compared.figures.undrawn;
    }
    if (page) page->commit();
    if (figures) figures->commit();
    if (undrawn) throw NoFigures(*undrawn);
}

std::optional<PairSummary> overPairs(const Brdf& a, const Brdf& b) {
    if (a.channels().count() != b.channels().count()) return std::nullopt;
    try {
        return summaryOf(a, b);
    } catch (const NumericError&) {
        return std::nullopt;
    }
}

/// None where nobody measured pairs, or where channels differ.
std::optional<AtSamples> atSamples(const Brdf& a, const Brdf& b,
                                   const std::vector<const Metric*>& asked) {
    const auto measured = brdfs::measuredPairs(a);
    const std::size_t channels = a.channels().count(), others = b.channels().count();
    if (!measured || measured->samples.chart != brdfs::Chart::anisotropic) return std::nullopt;
    if (others != channels && others != 1) return std::nullopt;
    const brdfs::Samples& samples = measured->samples;
    const std::size_t count = samples.size();
    std::vector<double> f(channels * count), g(channels * count), cosines, weights(count, 1.0);
    for (std::size_t k = 0; k < count; ++k) {
        const std::vector<double> there = evaluate(b, samples.wi[k], samples.wo[k]);
        for (std::size_t c = 0; c < channels; ++c) {
            f[c * count + k] = samples.values[k * channels + c];
            g[c * count + k] = there[others == 1 ? 0 : c];
        }
        cosines.push_back(samples.wi[k].z);
    }
    AtSamples result{count, compareSamples(f, g, cosines, weights)};
    std::erase_if(result.metrics, [&](const MetricValue& value) {
        return std::ranges::find(asked, value.metric) == asked.end();
    });
    return result;
}

/// A coefficient file has the name of its source; messages are about the file.
std::string messageName(const std::string& spec, const Brdf& brdf) {
    const auto* plain = dynamic_cast<const Reconstruction*>(&brdf);
    const auto* form = dynamic_cast<const RepresentedBrdf*>(&brdf);
    if (!plain && !form) return brdf.name();
    const Quantity quantity =
        plain ? plain->coefficients().quantity : form->representation().head.quantity;
    return quantity == Quantity::brdf
               ? spec
               : spec + " (coefficients of f cos(theta_i), divided by the cosine)";
}

/// The metrics that are asked for; without "reciprocity" for a transmission, whose directions
/// cannot be exchanged.
std::vector<const Metric*> metricsFor(const Brdf& a, const CompareOptions& options) {
    auto metrics = selectMetrics(options.metrics);
    if (!transmits(a)) return metrics;
    const auto dropped =
        std::erase_if(metrics, [](const Metric* metric) { return metric->name == "reciprocity"; });
    if (dropped > 0 && options.metrics != "all")
        throw UsageError(
            fmt::format("{}: is a transmission, whose directions are not exchanged; leave out the "
                        "metric reciprocity",
                        a.name()));
    return metrics;
}

Compared compareNamed(const Brdf& a, const Brdf& b, const std::array<std::string, 2>& names,
                      const std::string& output, const CompareOptions& options,
                      const Listener& listener) {
    requireSameSide(a, b);
    const auto metrics = metricsFor(a, options);
    Compared result{.a = a.name(), .b = b.name(), .outgoing = outgoingOf(options, a, b)};
    result.metrics = hshfit::compare(
        a, b, result.outgoing, metrics,
        {.reference = names[0], .approximation = names[1], .progress = listener.part("compare")});
    result.picture = pictureErrorOf(a, b);
    if (a.channels().reflectances() < a.channels().count())
        result.undrawn = a.channels().names()[a.channels().reflectances()];
    result.pairs = overPairs(a, b);
    result.samples = atSamples(a, b, metrics);
    const auto hasValue = [](const MetricValue& metric) { return metric.value.has_value(); };
    if (options.metrics != "all" && !std::ranges::all_of(result.metrics, hasValue))
        stateExitCode(static_cast<int>(ExitCode::numeric));
    if (!output.empty() || options.figures) writeFiles(a, b, output, options, listener, result);
    return result;
}

}  // namespace

Compared compare(const std::string& a, const std::string& b, const std::string& output,
                 const CompareOptions& options, const Listener& listener) {
    selectMetrics(options.metrics);  // a word that is none fails before any file is opened
    if (options.figures) checkFigures(*options.figures);
    const auto reference = openSource(a, options.rgb, Sides::eitherAndNamed),
               approximation = openSource(b, options.rgb, Sides::eitherAndNamed);
    return compareNamed(*reference, *approximation,
                        {messageName(a, *reference), messageName(b, *approximation)}, output,
                        options, listener);
}

Compared compareBrdfs(const Brdf& a, const Brdf& b, const std::string& output,
                      const CompareOptions& options, const Listener& listener) {
    return compareNamed(a, b, {a.name(), b.name()}, output, options, listener);
}

}  // namespace hshfit::jobs
