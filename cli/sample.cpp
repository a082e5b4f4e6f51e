#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "job_options.h"

#include <jobs/exports/sample.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct SampleArguments {
    std::string spec, output;
    jobs::SampleOptions options;
};

Json rowJson(const jobs::SampleRow& row) {
    const Efficiency& e = row.efficiency;
    return {{"outgoing", directionJson(e.wo)},
            {"samples", e.samples},
            {"mean", e.mean},
            {"standard_error", e.standardError},
            {"variance", e.variance},
            {"largest", e.largest},
            {"wasted", e.wasted},
            {"estimate", e.albedo},
            {"estimate_error", e.albedoError},
            {"albedo", row.albedo ? Json(*row.albedo) : Json(nullptr)},
            {"shares", row.shares}};
}

Json answerJson(const jobs::Sampled& done, const SampleArguments& arguments) {
    Json rows = Json::array(), samples = Json::array();
    for (const jobs::SampleRow& row : done.rows) rows.push_back(rowJson(row));
    if (arguments.output.empty())
        for (const jobs::DrawnDirection& one : done.drawn)
            samples.push_back({{"wi", {one.wi.x, one.wi.y, one.wi.z}},
                               {"pdf", one.pdf},
                               {"weights", one.weights}});
    Json document = {{"format", "hshfit-sample"},
                     {"version", 1},
                     {"brdf", done.brdf},
                     {"method", jobs::sampleMethodName(arguments.options.method)},
                     {"outgoing", directionJson(arguments.options.outgoing)},
                     {"seed", arguments.options.seed},
                     {"channels", done.channels},
                     {"parts", done.parts},
                     {"stored", done.stored},
                     {"reflects", done.reflects},
                     {"build_seconds", done.buildSeconds},
                     {"nanoseconds", done.nanosecondsPerSample},
                     {"efficiency", rowJson(done.here)},
                     {"elevations", rows},
                     {"count", done.drawn.size()}};
    if (arguments.output.empty())
        document["samples"] = samples;
    else
        document["output"] = arguments.output;
    return document;
}

double meanOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

std::string rowText(const jobs::SampleRow& row) {
    const Efficiency& e = row.efficiency;
    return fmt::format("{:8.1f}  {:>8}  {:8.5f}  {:<9.2g}  {:<8.3g}  {:<7.3g}  {:5.1f} %  {:.2f}\n",
                       degrees(polarAngle(e.wo)),
                       row.albedo ? fmt::format("{:.5f}", meanOf(*row.albedo)) : "none",
                       meanOf(e.albedo), e.standardError, e.variance, e.largest, 100 * e.wasted,
                       fmt::join(row.shares, " "));
}

std::string textOf(const jobs::Sampled& done, const std::string& output) {
    std::string text = fmt::format(
        "{}\nparts: {}{}\n theta_o    albedo  estimate  +-         variance  largest  wasted  "
        "shares\n",
        done.brdf, fmt::join(done.parts, " | "),
        done.stored ? " (the proposal is that of the export)" : "");
    text += rowText(done.here);
    if (!done.rows.empty()) text += "by elevation:\n";
    for (const jobs::SampleRow& row : done.rows) text += rowText(row);
    if (!output.empty()) text += fmt::format("{}: {} directions\n", output, done.drawn.size());
    return text;
}

void runSample(const SampleArguments& arguments, const Globals& globals) {
    const jobs::Sampled done = jobs::sample(arguments.spec, arguments.output, arguments.options);
    if (!done.reflects)
        note(globals, "f is 0 at this outgoing direction: samples are drawn from the cosine");
    if (globals.json) return printJson(answerJson(done, arguments));
    printText(textOf(done, arguments.output));
}

constexpr ArgumentRow sampleArguments[] = {
    required("SPEC", at<&SampleArguments::spec>, "BRDF, coefficient file or sidecar of an export",
             brdfRead),
    optionalOutput(at<&SampleArguments::output>, "CSV of the directions, densities and weights",
                   {.files = Files::written, .dash = ".csv"}),
};

}  // namespace

CommandRows sampleRows() {
    return {sampleArguments, {jobs::sampleOptions().rows}};
}

void addSample(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<SampleArguments>();
    addArguments(command, sampleArguments, *arguments);
    addOptions(command, jobs::sampleOptions(), arguments->options);
    command.callback([arguments, &globals] { runSample(*arguments, globals); });
}

}  // namespace hshfit::cli
