#include "compare.h"

#include "source.h"

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/representation/forms/represented_brdf.h>

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

/// The page, whose table holds every metric, including those that were not asked for.
std::vector<std::string> writePage(const Brdf& a, const Brdf& b, const Compared& compared,
                                   const std::string& folder, const CompareOptions& options,
                                   const Listener& listener) {
    ComparisonOptions page{.outgoing = compared.outgoing};
    if (options.metrics == "all") page.metrics = compared.metrics;
    page.progress = page.sphere.progress = listener.part("report");
    return writeComparison(a, b, page, folder);
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
    const auto reference = openSource(a, options.rgb), approximation = openSource(b, options.rgb);
    return compareBrdfs(*reference, *approximation, output, options, listener);
}

Compared compareBrdfs(const Brdf& a, const Brdf& b, const std::string& output,
                      const CompareOptions& options, const Listener& listener) {
    const auto metrics = selectMetrics(options.metrics);
    Compared result{.a = a.name(), .b = b.name(), .outgoing = outgoingOf(options, a, b)};
    result.metrics =
        hshfit::compare(a, b, result.outgoing, metrics, {.progress = listener.part("compare")});
    result.pairs = overPairs(a, b);
    if (!output.empty()) result.files = writePage(a, b, result, output, options, listener);
    return result;
}

}  // namespace hshfit::jobs
