#include "command.h"
#include "documents.h"
#include "figure_options.h"

#include <hshfit/error.h>
#include <hshfit/pages/pair_summary_json.h>

#include <jobs/compare.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareArguments {
    std::string a, b, output;
    FigureArguments figures;
    jobs::CompareOptions options;
};

Json answer(const jobs::Compared& compared, const CompareArguments& arguments) {
    Json document = {{"format", "hshfit-compare"},
                     {"version", 1},
                     {"a", compared.a},
                     {"b", compared.b},
                     {"outgoing", compared.outgoing.spec()},
                     {"metrics", metricValuesJson(compared.metrics)}};
    if (compared.pairs) document["pairs"] = pairSummaryJson(*compared.pairs);
    if (!compared.files.empty())
        document["report"] = {{"folder", arguments.output}, {"files", compared.files}};
    if (!compared.figures.names.empty())
        document["figures"] = figuresJson(compared.figures, arguments.figures.folder);
    return document;
}

std::string text(const jobs::Compared& compared, const CompareArguments& arguments) {
    std::string out = fmt::format("{} against {}, outgoing {}\n", arguments.b, arguments.a,
                                  compared.outgoing.spec());
    for (const MetricValue& result : compared.metrics) out += metricText(result);
    if (compared.pairs) out += "  " + indented(textOf(*compared.pairs));
    if (!compared.files.empty())
        out += fmt::format("written to {}: comparison.html and {} files beside it\n",
                           arguments.output, compared.files.size() - 1);
    return out + figuresText(compared.figures, arguments.figures);
}

void runCompare(CompareArguments& arguments, Globals& globals) {
    arguments.options.figures = arguments.figures.parsed();
    if (!arguments.options.sigma.empty() && arguments.figures.folder.empty())
        throw UsageError("compare: --sigma is for the bars of figures; give --figures DIR");
    const jobs::Compared compared = jobs::compare(arguments.a, arguments.b, arguments.output,
                                                  arguments.options, listenerFor(globals));
    if (globals.json)
        printJson(answer(compared, arguments));
    else
        printText(text(compared, arguments));
    noteFont(compared.figures, arguments.figures, globals);
    // A metric without a value is an error if it was named, and a row of the table otherwise.
    const bool named = arguments.options.metrics != "all";
    for (const MetricValue& result : compared.metrics) {
        if (named && !result.value) globals.exitCode = static_cast<int>(ExitCode::numeric);
    }
}

}  // namespace

void addCompare(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<CompareArguments>();
    command.add_option("A", arguments->a, "Reference: BRDF or coefficient file")->required();
    command.add_option("B", arguments->b, "Approximation: BRDF or coefficient file")->required();
    command
        .add_option("--metrics", arguments->options.metrics,
                    "all, or names from hshfit list metrics")
        ->capture_default_str();
    command.add_option("--outgoing", arguments->options.outgoing,
                       "WxH, N or THETA,PHI (default: those of the coefficient file; else 16, or "
                       "16x16 if anisotropic)");
    command.add_option("-o,--output", arguments->output,
                       "Folder for a page with figures and spheres, made if absent");
    addFigureOptions(command, arguments->figures);
    command.add_option("--sigma", arguments->options.sigma,
                       "Standard uncertainty of measured samples of A, for bars in the figures: "
                       "2%+0.001, column, or FILE.csv");
    addRgb(command, arguments->options.rgb);
    command.callback([arguments, &globals] { runCompare(*arguments, globals); });
}

}  // namespace hshfit::cli
