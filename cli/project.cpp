#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "form_lines.h"
#include "job_options.h"
#include "measured_numbers.h"

#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/pages/pair_summary_json.h>
#include <hshfit/pages/picture_error_json.h>

#include <jobs/common/kept_outputs.h>
#include <jobs/studies/project.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ProjectArguments {
    std::vector<std::string> specs;
    std::string output, files = "json";
    jobs::ProjectOptions options;
};

Json answer(const jobs::Projected& result) {
    const Projection& projection = result.projection;
    const Coefficients& c = projection.coefficients;
    Json energy = {{"value", c.energy.finite ? Json(c.energy.value) : Json(nullptr)},
                   {"error", c.energy.finite ? Json(c.energy.error) : Json(nullptr)},
                   {"finite", c.energy.finite}};
    if (!c.energy.finite) energy["reason"] = c.energy.reason;
    Json document = {{"format", "hshfit-project"},
                     {"version", 1},
                     {"brdf", c.source},
                     {"output", result.output},
                     {"basis", c.basis},
                     {"order", c.order},
                     {"quantity", quantityName(c.quantity)},
                     {"outgoing", c.outgoing.spec()},
                     {"directions", c.outgoing.size()},
                     {"channels", c.channels.names()},
                     {"energy", energy},
                     {"accuracy", result.captured ? Json(*result.captured) : Json(nullptr)},
                     {"error", c.error},
                     {"tolerance", c.tolerance},
                     {"evaluations", projection.evaluations}};
    if (c.leastSquares) {
        document["least_squares"] = {{"regularisation", c.leastSquares->regularisation},
                                     {"kernel_degrees", c.leastSquares->kernelDegrees},
                                     {"condition", c.leastSquares->condition},
                                     {"residual", c.leastSquares->residual},
                                     {"samples", c.leastSquares->samples}};
    }
    if (const std::string_view side = transmissionSide(c.source); !side.empty())
        document["side"] = side;
    if (result.kept) document["representation"] = describeForm(*result.kept);
    if (result.poor) document["poor"] = jobs::poorJson(*result.poor);
    if (result.picture) document["picture"] = pictureErrorJson(*result.picture);
    if (result.errors) document["pairs"] = pairSummaryJson(*result.errors);
    return document;
}

std::string_view functionOf(const Coefficients& c) {
    return c.quantity == Quantity::brdfCosine ? "f cos(theta_i)" : "f";
}

void noteQuality(const jobs::Projected& result, const std::string& prefix, const Globals& globals) {
    const Energy& energy = result.projection.coefficients.energy;
    // The halfway form has the energy of f cos cos, which its errors state.
    const bool halfway = result.kept && result.kept->kind() == Representation::Kind::halfway;
    if (!energy.finite && !halfway)
        note(globals, fmt::format("{}the energy of {} does not exist: {}", prefix,
                                  functionOf(result.projection.coefficients), energy.reason));
    if (!result.remark.empty()) note(globals, result.remark);
    if (const auto side = transmissionSide(result.projection.coefficients.source); !side.empty())
        note(globals, fmt::format("{}coefficients of {}: outgoing (x, y, z) stands for (x, y, -z)",
                                  prefix, side));
    if (result.poor) note(globals, prefix + result.poor->line());
}

std::string capturedText(const jobs::Projected& result) {
    if (!result.captured) return std::string(noCapturedEnergy);
    const Coefficients& c = result.projection.coefficients;
    const std::string_view captured = result.kept ? jobs::capturedFunction(*result.kept)
                                                  : jobs::capturedFunction(result.projection);
    // Named where it is not that of the coefficients' own function.
    return captured == functionOf(c)
               ? fmt::format("{:.6f} of the energy captured", *result.captured)
               : fmt::format("{:.6f} of the energy of {} captured", *result.captured, captured);
}

std::string linesWithoutPicture(const jobs::Projected& result) {
    const Coefficients& c = result.projection.coefficients;
    const std::string& output = result.output;
    if (result.kept) {
        const std::string what =
            c.basis.empty() ? "" : fmt::format("{} order {}, ", c.basis, c.order);
        // The errors over pairs say what a quadrature cannot.
        const std::string error = result.errors ? indented(textOf(*result.errors))
                                                : fmt::format("{}, quadrature error {:.1e}\n",
                                                              capturedText(result), c.error);
        return fmt::format("{}: {}{}{}", output, what, error, formLine(*result.kept));
    }
    if (const auto& fit = c.leastSquares) {
        return fmt::format(
            "{}: {} order {}, {} directions, least squares over {} samples, condition {:.2g}, "
            "residual {:.3g}\n",
            output, c.basis, c.order, c.outgoing.size(), fit->samples, fit->condition,
            fit->residual);
    }
    return fmt::format("{}: {} order {}, {} directions, {}, quadrature error {:.1e}\n", output,
                       c.basis, c.order, c.outgoing.size(), capturedText(result), c.error);
}

std::string line(const jobs::Projected& result) {
    const std::string picture =
        result.picture ? "  " + summaryOf(*result.picture) + "\n" : std::string();
    return linesWithoutPicture(result) + picture;
}

void projectOne(const ProjectArguments& arguments, const Globals& globals) {
    const jobs::Projected result = jobs::project(arguments.specs[0], arguments.output,
                                                 arguments.options, listenerFor(globals));
    noteQuality(result, "", globals);
    const Json document = answer(result);
    if (globals.json)
        printJson(document);
    else
        printText(line(result));
}

/// Every input to a file of its own in the folder `-o`.
void projectMany(const ProjectArguments& arguments, Globals& globals) {
    const jobs::ManyProjected many =
        jobs::projectMany(arguments.specs, arguments.output, "." + arguments.files,
                          arguments.options, listenerFor(globals));
    Json documents = Json::array();
    std::string text;
    for (const std::string& kept : many.kept) text += jobs::keptLine(kept) + "\n";
    for (const auto& result : many.results) {
        if (!result) continue;
        noteQuality(*result, result->projection.coefficients.source + ": ", globals);
        documents.push_back(answer(*result));
        text += line(*result);
    }
    if (globals.json)
        printJson({{"format", "hshfit-projects"},
                   {"version", 1},
                   {"projections", documents},
                   {"kept", many.kept},
                   {"failures", failuresJson(many.failures)}});
    else
        printText(text);
    reportFailures(many.failures, many.specs.size() + many.kept.size(), globals);
}

void runProject(const ProjectArguments& arguments, Globals& globals) {
    if (jobs::areMany(arguments.specs))
        projectMany(arguments, globals);
    else
        projectOne(arguments, globals);
}

std::vector<Word> fileWords() {
    return {{"json"}, {"exr"}};
}

constexpr ArgumentRow projectArguments[] = {
    required("SPEC", at<&ProjectArguments::specs>,
             "One or more BRDFs; of a folder, the measured files in it", brdfRead),
    requiredOutput(at<&ProjectArguments::output>,
                   "Coefficient file, .json or .exr; for many BRDFs, the folder for their files",
                   jsonWritten),
    optional("files", at<&ProjectArguments::files>, "With many BRDFs: json or exr",
             {.words = fileWords, .complete = true}),
};

}  // namespace

CommandRows projectRows() {
    return {projectArguments, {jobs::projectOptions().rows, jobs::formOptions().rows}};
}

void addProject(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ProjectArguments>();
    addArguments(command, projectArguments, *arguments);
    addOptions(command, jobs::projectOptions(), arguments->options);
    addOptions(command, jobs::formOptions(), arguments->options.form, "Form");
    command.callback([arguments, &globals] { runProject(*arguments, globals); });
}

}  // namespace hshfit::cli
