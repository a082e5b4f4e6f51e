#include "command.h"
#include "documents.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/pages/pair_summary_json.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <jobs/source.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <optional>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareArguments {
    std::string a, b, metrics = "all", outgoing, output;
    bool rgb = false;
};

/// Coefficients are compared at their own outgoing directions unless others are asked for.
OutgoingSet outgoingOf(const CompareArguments& arguments, const Brdf& a, const Brdf& b) {
    if (arguments.outgoing.empty()) {
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
    return jobs::outgoingOrDefault(arguments.outgoing, a.laws().isotropic ? b : a);
}

/// Writes the page. Its table holds every metric, including those that are not printed.
std::vector<std::string> writePage(const Brdf& a, const Brdf& b, const OutgoingSet& outgoing,
                                   const std::vector<MetricValue>& results,
                                   const CompareArguments& arguments, const Globals& globals) {
    ComparisonOptions options{.outgoing = outgoing};
    if (arguments.metrics == "all") options.metrics = results;
    Progress progress(globals, "report");
    options.progress = options.sphere.progress = progress.callback();
    return writeComparison(a, b, options, arguments.output);
}

/// The errors over both hemispheres, as other commands give them: the outgoing set passes over the
/// horizon. None where channels differ or the reference is not finite.
std::optional<PairSummary> overPairs(const Brdf& a, const Brdf& b) {
    if (a.channels().count() != b.channels().count()) return std::nullopt;
    try {
        return summaryOf(a, b);
    } catch (const NumericError&) {
        return std::nullopt;
    }
}

void runCompare(const CompareArguments& arguments, Globals& globals) {
    const auto metrics = selectMetrics(arguments.metrics);
    const auto a = jobs::openSource(arguments.a, arguments.rgb),
               b = jobs::openSource(arguments.b, arguments.rgb);
    const OutgoingSet outgoing = outgoingOf(arguments, *a, *b);
    Progress progress(globals, "compare");
    const auto results = compare(*a, *b, outgoing, metrics, {.progress = progress.callback()});

    Json document = {{"format", "hshfit-compare"},
                     {"version", 1},
                     {"a", a->name()},
                     {"b", b->name()},
                     {"outgoing", outgoing.spec()},
                     {"metrics", Json::array()}};
    std::string text =
        fmt::format("{} against {}, outgoing {}\n", arguments.b, arguments.a, outgoing.spec());
    for (const MetricValue& result : results) {
        document["metrics"].push_back(metricJson(result));
        text += metricText(result);
    }
    if (const auto pairs = overPairs(*a, *b)) {
        document["pairs"] = pairSummaryJson(*pairs);
        text += "  " + indented(textOf(*pairs));
    }
    if (!arguments.output.empty()) {
        const auto written = writePage(*a, *b, outgoing, results, arguments, globals);
        document["report"] = {{"folder", arguments.output}, {"files", written}};
        text += fmt::format("written to {}: comparison.html and {} files beside it\n",
                            arguments.output, written.size() - 1);
    }
    if (globals.json) {
        printJson(document);
    } else {
        printText(text);
    }
    // A metric without a value is an error if it was named, and a row of the table otherwise.
    const bool named = arguments.metrics != "all";
    for (const MetricValue& result : results) {
        if (named && !result.value) globals.exitCode = 4;
    }
}

}  // namespace

void addCompare(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<CompareArguments>();
    command.add_option("A", arguments->a, "Reference: BRDF or coefficient file")->required();
    command.add_option("B", arguments->b, "Approximation: BRDF or coefficient file")->required();
    command.add_option("--metrics", arguments->metrics, "all, or names from hshfit list metrics")
        ->capture_default_str();
    command.add_option("--outgoing", arguments->outgoing,
                       "WxH, N or THETA,PHI (default: those of the coefficient file; else 16, or "
                       "16x16 if anisotropic)");
    command.add_option("-o,--output", arguments->output,
                       "Folder for a page with figures and spheres, made if absent");
    addRgb(command, arguments->rgb);
    command.callback([arguments, &globals] { runCompare(*arguments, globals); });
}

}  // namespace hshfit::cli
