#include "compare.h"

#include "picture.h"
#include "source.h"

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <algorithm>
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

}  // namespace

Compared compare(const std::string& a, const std::string& b, const std::string& output,
                 const CompareOptions& options, const Listener& listener) {
    selectMetrics(options.metrics);  // a word that is none fails before any file is opened
    if (options.figures) checkFigures(*options.figures);
    const auto reference = openSource(a, options.rgb), approximation = openSource(b, options.rgb);
    return compareBrdfs(*reference, *approximation, output, options, listener);
}

Compared compareBrdfs(const Brdf& a, const Brdf& b, const std::string& output,
                      const CompareOptions& options, const Listener& listener) {
    const auto metrics = selectMetrics(options.metrics);
    Compared result{.a = a.name(), .b = b.name(), .outgoing = outgoingOf(options, a, b)};
    result.metrics =
        hshfit::compare(a, b, result.outgoing, metrics, {.progress = listener.part("compare")});
    result.picture = pictureErrorOf(a, b);
    result.pairs = overPairs(a, b);
    const auto hasValue = [](const MetricValue& metric) { return metric.value.has_value(); };
    if (options.metrics != "all" && !std::ranges::all_of(result.metrics, hasValue))
        stateExitCode(static_cast<int>(ExitCode::numeric));
    if (!output.empty() || options.figures) writeFiles(a, b, output, options, listener, result);
    return result;
}

}  // namespace hshfit::jobs
