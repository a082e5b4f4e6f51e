#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "figure_lines.h"
#include "job_options.h"
#include "measured_numbers.h"

#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/pages/pair_summary_json.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/percent.h>

#include <jobs/common/kept_outputs.h>
#include <jobs/studies/compare.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareArguments {
    std::string a, output;
    std::vector<std::string> others;
    jobs::FigureArguments figures;
    jobs::CompareOptions options;
};

Json answer(const jobs::Compared& compared, const CompareArguments& arguments) {
    Json document = {{"format", "hshfit-compare"},
                     {"version", 1},
                     {"a", compared.a},
                     {"b", compared.b},
                     {"outgoing", compared.outgoing.spec()}};
    if (const auto side = transmissionSide(compared.a); !side.empty()) document["side"] = side;
    if (compared.picture) document["picture"] = pictureErrorJson(*compared.picture);
    document["metrics"] = metricValuesJson(compared.metrics);
    if (compared.pairs) document["pairs"] = pairSummaryJson(*compared.pairs);
    if (compared.samples)
        document["samples"] = {{"count", compared.samples->count},
                               {"metrics", metricValuesJson(compared.samples->metrics)}};
    if (!compared.files.empty())
        document["report"] = {{"folder", arguments.output}, {"files", compared.files}};
    if (!compared.figures.names.empty())
        document["figures"] = figuresJson(compared.figures, arguments.figures.figures);
    return document;
}

/// The text with BRDFs named as they were given, whose own names may state forty parameters. A file
/// of coefficients has the name of its source: where both have one name, the text keeps it.
std::string asGiven(std::string text, const jobs::Compared& compared,
                    const CompareArguments& arguments) {
    if (compared.a == compared.b) return text;
    for (const auto& [name, given] :
         {std::pair{&compared.b, &arguments.others[0]}, std::pair{&compared.a, &arguments.a}}) {
        if (given->size() >= name->size()) continue;
        for (std::size_t at = text.find(*name); at != std::string::npos;
             at = text.find(*name, at + given->size()))
            text.replace(at, name->size(), *given);
    }
    return text;
}

/// Lines of metrics. A reason that several of them have is stated once.
std::string metricsText(const jobs::Compared& compared, const CompareArguments& arguments) {
    std::string out;
    std::map<std::string, std::string> reasons;  // the first metric of each
    for (MetricValue result : compared.metrics) {
        if (!result.value) {
            const auto [first, isNew] =
                reasons.emplace(result.reason, std::string(result.metric->name));
            result.reason = isNew ? asGiven(result.reason, compared, arguments)
                                  : fmt::format("as {}", first->second);
        }
        out += metricText(result);
    }
    return out;
}

std::string text(const jobs::Compared& compared, const CompareArguments& arguments) {
    std::string out = fmt::format("{} against {}, outgoing {}\n", arguments.others[0], arguments.a,
                                  compared.outgoing.spec());
    if (compared.picture) out += "  " + indented(textOf(*compared.picture));
    if (const auto side = transmissionSide(compared.a); !side.empty())
        out += fmt::format("  {}{}\n", side,
                           compared.picture ? ": drawn as if it were reflected" : "");
    if (!compared.undrawn.empty())
        out += fmt::format("  no picture error: {} is no reflectance\n", compared.undrawn);
    out += metricsText(compared, arguments);
    if (compared.pairs) out += "  " + indented(textOf(*compared.pairs));
    if (compared.samples) {
        out += fmt::format("  at the {} measured pairs of {} alone:\n", compared.samples->count,
                           arguments.a);
        for (const MetricValue& result : compared.samples->metrics)
            if (result.value) out += metricText(result);
    }
    if (!compared.files.empty())
        out += fmt::format("written to {}: comparison.html and {} files beside it\n",
                           arguments.output, compared.files.size() - 1);
    return out + figuresText(compared.figures, arguments.figures);
}

/// A metric without a value is an error if it was named, and a row of the table otherwise.
void requireNamed(const jobs::Compared& compared, const CompareArguments& arguments,
                  Globals& globals) {
    if (arguments.options.metrics == "all") return;
    for (const MetricValue& result : compared.metrics)
        if (!result.value)
            endWithoutNumbers(
                globals, fmt::format("{}: {}: {}", compared.a, result.metric->name, result.reason));
}

void compareTwo(const CompareArguments& arguments, Globals& globals) {
    const jobs::Compared compared =
        jobs::compare(arguments.a, arguments.others[0], arguments.output, arguments.options,
                      listenerFor(globals));
    if (globals.json)
        printJson(answer(compared, arguments));
    else
        printText(text(compared, arguments));
    noteFont(compared.figures, arguments.figures, globals);
    requireNamed(compared, arguments, globals);
}

/// The columns of the table on a terminal: where each is the largest, so that no mean hides one.
std::string tableText(const jobs::ManyCompared& many) {
    std::size_t width = 4;
    for (const std::string& name : many.names) width = std::max(width, name.size());
    std::string text = fmt::format("{:<{}}  {:>5}  {:>14}  {:>22}  {:>22}  {:>10}  {:>22}\n",
                                   "name", width, "FLIP", "false extremum", "relative L2 of f c",
                                   "energy left", "largest", "albedo");
    for (std::size_t i = 0; i < many.names.size(); ++i) {
        if (!many.results[i]) continue;
        const auto& picture = many.results[i]->picture;
        text += fmt::format(
            "{:<{}}  {:>5}  {:>14}", many.names[i], width,
            picture ? fmt::format("{:.3f}", picture->flip.mean) : "none",
            picture ? percent(std::max(picture->dip.value, picture->peak.value), 2) : "none");
        const auto& pairs = many.results[i]->pairs;
        if (!pairs) {
            text += "  no errors over pairs of directions: --json says why\n";
            continue;
        }
        text += fmt::format("  {:>22}  {:>22}  {:>10.4g}  {:>22}\n",
                            withError(pairs->relativeL2.value, pairs->relativeL2.error),
                            withError(pairs->energyLeft.value, pairs->energyLeft.error),
                            pairs->maximum, withError(pairs->albedo.value, pairs->albedo.error));
    }
    return text;
}

void compareMany(const CompareArguments& arguments, Globals& globals) {
    const jobs::ManyCompared many = jobs::compareMany(
        arguments.a, arguments.others, arguments.output, arguments.options, listenerFor(globals));
    Json documents = Json::array();
    for (std::size_t i = 0; i < many.results.size(); ++i) {
        if (!many.results[i]) continue;
        CompareArguments ofPair = arguments;
        ofPair.output = many.folders.empty() ? "" : many.folders[i];
        documents.push_back(answer(*many.results[i], ofPair));
        requireNamed(*many.results[i], arguments, globals);
    }
    if (!arguments.output.empty())
        writeComparisonTable(
            many, (std::filesystem::path(arguments.output) / "comparisons.csv").string());
    if (globals.json) {
        printJson({{"format", "hshfit-compares"},
                   {"version", 1},
                   {"comparisons", documents},
                   {"kept", many.kept},
                   {"failures", failuresJson(many.failures)}});
    } else {
        std::string text;
        for (const std::string& kept : many.kept) text += jobs::keptLine(kept) + "\n";
        text += tableText(many);
        if (!arguments.output.empty())
            text += fmt::format("written to {}: comparisons.csv and a folder for each pair\n",
                                arguments.output);
        printText(text);
    }
    reportFailures(many.failures, many.names.size(), globals);
}

void runCompare(CompareArguments& arguments, Globals& globals) {
    arguments.options.figures = arguments.figures.parsed();
    if (!arguments.options.sigma.empty() && arguments.figures.figures.empty())
        throw UsageError("compare: --sigma is for the bars of figures; give --figures DIR");
    // Two specifications, neither of them a folder or a pattern, have an answer of their own.
    const bool many = arguments.others.size() > 1 || jobs::areMany({arguments.a}) ||
                      jobs::areMany(arguments.others);
    if (many && arguments.options.figures)
        throw UsageError("compare: --figures is for one A and one B");
    many ? compareMany(arguments, globals) : compareTwo(arguments, globals);
}

constexpr ArgumentRow compareArguments[] = {
    required("A", at<&CompareArguments::a>,
             "Reference: BRDF or coefficient file; a folder or pattern for pairs by name",
             brdfRead),
    required("B", at<&CompareArguments::others>,
             "Approximation: BRDF or coefficient file; several, a folder or a pattern", brdfRead),
    optionalOutput(at<&CompareArguments::output>,
                   "Folder for a page with figures and spheres, made if absent; of several, for "
                   "a table and a folder each",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows compareRows() {
    return {compareArguments, {jobs::compareOptions().rows, jobs::figureOptions().rows}};
}

void addCompare(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<CompareArguments>();
    addArguments(command, compareArguments, *arguments);
    addOptions(command, jobs::compareOptions(), arguments->options);
    addOptions(command, jobs::figureOptions(), arguments->figures, "Figures for print");
    command.callback([arguments, &globals] { runCompare(*arguments, globals); });
}

}  // namespace hshfit::cli
