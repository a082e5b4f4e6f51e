#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "job_options.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/error.h>
#include <hshfit/files/standard_streams.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/percent.h>

#include <brdfs/catalog.h>

#include <jobs/studies/convert.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ConvertArguments {
    std::string input, output, folder;
    std::vector<std::string> more;  ///< inputs, with a folder for the results
    jobs::ConvertOptions options;
};

Json repairsJson(const jobs::Repairs& repairs) {
    Json rows = Json::array();
    for (const auto& count : repairs.counts) {
        rows.push_back({{"name", count.name},
                        {"values", repairs.evaluated},
                        {"changed", count.changed},
                        {"left", count.left}});
        if (!count.check) continue;
        const brdfs::FillCheck& check = *count.check;
        rows.back()["filled_by_angle"] = count.byAngle;
        rows.back()["check"] = {
            {"pairs", check.pairs},
            {"reach", check.reach},
            {"noise", check.noise},
            {"median", check.median},
            {"percentile_95", check.percentile95},
            {"largest", check.largest},
            {"worst",
             {{"wi", directionJson(check.worstWi)}, {"wo", directionJson(check.worstWo)}}}};
    }
    return rows;
}

Json document(const jobs::Converted& converted, const std::string& output) {
    Json document = {{"format", "hshfit-convert"},
                     {"version", 1},
                     {"input", converted.input},
                     {"output", output},
                     {"written", converted.written},
                     {"altered", converted.altered},
                     {"bytes", converted.bytes},
                     {"error", converted.error ? Json(*converted.error) : Json(nullptr)}};
    if (converted.error) document["error_over"] = converted.errorOver;
    if (converted.picture) document["picture"] = pictureErrorJson(*converted.picture);
    if (converted.poor) document["poor"] = jobs::poorJson(*converted.poor);
    if (converted.repairs) document["repairs"] = repairsJson(*converted.repairs);
    if (const auto& loss = converted.loss) {
        Json rows = Json::array();
        for (const MetricValue& result : loss->metrics) rows.push_back(metricJson(result));
        document["loss"] = {{"outgoing", loss->outgoing}, {"metrics", std::move(rows)}};
    }
    return document;
}

std::string convertText(const Json& document, const jobs::Converted& converted) {
    const std::optional<jobs::ConversionLoss>& loss = converted.loss;
    std::string text = fmt::format("{}: {}", document["output"].get<std::string>(),
                                   document["written"].get<std::string>());
    const std::size_t bytes = document["bytes"];  // 0: they went to standard output
    text += bytes > 0 ? fmt::format(", {} bytes\n", bytes) : "\n";
    for (const Json& sentence : document["altered"]) {
        text += fmt::format("  altered: {}\n", sentence.get<std::string>());
    }
    for (const Json& row : document.value("repairs", Json::array())) {
        text +=
            fmt::format("  repaired: {} changed {} of {} values", row["name"].get<std::string>(),
                        row["changed"].get<std::uint64_t>(), row["values"].get<std::uint64_t>());
        if (row["left"] != 0)
            text += fmt::format(" and left {} as they were", row["left"].get<std::uint64_t>());
        text += "\n";
        if (!row.contains("check")) continue;
        const Json& check = row["check"];
        text += fmt::format(
            "    held out: {} covered pairs, {} degrees from their neighbours as the holes are, "
            "come "
            "back to {:.2g} %, 95 of 100 to {:.2g} %; the source scatters by {:.2g} %\n",
            check["pairs"].get<std::size_t>(), check["reach"].get<double>(),
            100 * check["median"].get<double>(), 100 * check["percentile_95"].get<double>(),
            100 * check["noise"].get<double>());
    }
    if (converted.error) {
        text += fmt::format("  read back: {} off over {}", percent(*converted.error),
                            converted.errorOver);
        if (converted.picture && !loss) text += "; " + summaryOf(*converted.picture);
        text += "\n";
    }
    if (!loss) return text;
    if (converted.picture) text += "  " + indented(textOf(*converted.picture));
    text += fmt::format("loss, outgoing {}\n", loss->outgoing);
    for (const MetricValue& result : loss->metrics) text += metricText(result);
    return text;
}

void convertOne(const ConvertArguments& arguments, const Globals& globals) {
    const jobs::Converted converted =
        jobs::convert(arguments.input, arguments.output, arguments.options, listenerFor(globals));
    if (converted.poor) note(globals, converted.poor->line());
    const Json answer = document(converted, arguments.output);
    if (globals.json) {
        printJson(answer);
    } else {
        printText(convertText(answer, converted));
    }
}

/// Every input to a file of its own in the folder `-o`.
void convertMany(const ConvertArguments& arguments, Globals& globals) {
    std::vector<std::string> inputs{arguments.input};
    if (!arguments.output.empty()) inputs.push_back(arguments.output);
    inputs.insert(inputs.end(), arguments.more.begin(), arguments.more.end());
    if (std::ranges::any_of(inputs, isStandardOutput))
        throw UsageError("convert -o: several files are written; '-' is not one of the inputs");
    const auto many =
        jobs::convertMany(inputs, arguments.folder, arguments.options, listenerFor(globals));
    Json documents = Json::array();
    std::string text;
    for (std::size_t i = 0; i < many.results.size(); ++i) {
        const auto& converted = many.results[i];
        if (!converted) continue;
        if (converted->poor) note(globals, converted->poor->line());
        documents.push_back(document(*converted, many.outputs[i]));
        text += convertText(documents.back(), *converted);
    }
    if (globals.json)
        printJson({{"format", "hshfit-converts"},
                   {"version", 1},
                   {"conversions", documents},
                   {"kept", many.kept},
                   {"failures", failuresJson(many.failures)}});
    else
        printText(text);
    reportFailures(many.failures, many.specs.size() + many.kept.size(), globals);
}

void runConvert(const ConvertArguments& arguments, Globals& globals) {
    if (!arguments.folder.empty()) return convertMany(arguments, globals);
    if (arguments.output.empty())
        throw UsageError("convert: give IN and OUT, or one or more IN and the folder -o DIR");
    if (!arguments.more.empty())
        throw UsageError("convert: several inputs go to a folder; give -o DIR and --to FORMAT");
    convertOne(arguments, globals);
}

constexpr ArgumentRow convertArguments[] = {
    required("IN", at<&ConvertArguments::input>,
             "BRDF, measured file or coefficient file; with -o also a folder of measured files",
             brdfRead),
    optional("OUT", at<&ConvertArguments::output>, "File to write; with -o another IN",
             {.files = Files::written, .dash = ""}),
    optional("MORE", at<&ConvertArguments::more>, "With -o: further IN",
             {.syntax = Syntax::brdf, .files = Files::read}),
    optionalOutput(at<&ConvertArguments::folder>,
                   "Folder for the files of one or more IN, each named after its input; needs --to",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows convertRows() {
    return {convertArguments, {jobs::convertOptions().rows}};
}

void addConvert(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ConvertArguments>();
    addArguments(command, convertArguments, *arguments);
    addOptions(command, jobs::convertOptions(), arguments->options);
    command.callback([arguments, &globals] { runConvert(*arguments, globals); });
}

}  // namespace hshfit::cli
