#include "command.h"
#include "form_options.h"
#include "inputs.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/projection/least_squares.h>
#include <hshfit/projection/projection.h>

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/scattered.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <system_error>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* defaultMap = "32x32";

struct ProjectOptions {
    std::vector<std::string> specs;
    std::string output, basis = "hsh", outgoing, files = "json";
    FormOptions form;
    int order = 7;
    bool cosine = false, condonShortley = false, rgb = false;
    double tolerance = 0;
    bool leastSquares = false;
    double regularise = 1e-3, kernel = 20;
    double maxEvaluations = static_cast<double>(ProjectionOptions{}.maxEvaluations);
};

/// A projection and, where a form was asked for, what the file keeps of it.
struct Result {
    Projection projection;
    std::optional<Representation> kept = {};
};

Json answer(const Result& result, const std::string& output) {
    const Projection& projection = result.projection;
    const Coefficients& c = projection.coefficients;
    Json energy = {{"value", c.energy.finite ? Json(c.energy.value) : Json(nullptr)},
                   {"error", c.energy.finite ? Json(c.energy.error) : Json(nullptr)},
                   {"finite", c.energy.finite}};
    if (!c.energy.finite) energy["reason"] = c.energy.reason;
    const bool known = c.energy.finite && c.energy.value > 0 && !projection.captured.empty();
    Json document = {
        {"format", "hshfit-project"},
        {"version", 1},
        {"brdf", c.source},
        {"output", output},
        {"basis", c.basis},
        {"order", c.order},
        {"quantity", quantityName(c.quantity)},
        {"outgoing", c.outgoing.spec()},
        {"directions", c.outgoing.size()},
        {"channels", c.channels.names()},
        {"energy", energy},
        {"accuracy", known ? Json(projection.captured.back() / c.energy.value) : Json(nullptr)},
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
    if (result.kept) document["representation"] = describeForm(*result.kept);
    return document;
}

/// Scattered samples straight to coefficients, without interpolating between them.
Projection projectSamples(const Brdf& brdf, const Basis& basis, const OutgoingSet& outgoing,
                          const ProjectOptions& options, ProgressCall progress) {
    const auto* scattered = dynamic_cast<const brdfs::Scattered*>(&brdf);
    if (!scattered) {
        throw UsageError(fmt::format(
            "{}: --least-squares is for files of scattered samples; project others without it",
            brdf.name()));
    }
    LeastSquaresProjection fit =
        projectLeastSquares(scattered->directionSamples(), basis, outgoing,
                            {.quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf,
                             .regularisation = options.regularise,
                             .kernel = radians(options.kernel),
                             .progress = std::move(progress)});
    return {.coefficients = std::move(fit.coefficients), .captured = {}, .evaluations = 0};
}

/// What all inputs of a command share.
struct Job {
    const ProjectOptions& options;
    std::unique_ptr<Basis> basis;
    OutgoingSet outgoing;
    std::optional<Form> form;

    Result run(const std::string& spec, const std::string& output,
               const ProgressCall& progress) const {
        const auto brdf = openBrdf(spec, options.rgb);
        const ProjectionOptions how = {
            .quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf,
            .tolerance = options.tolerance,
            .maxEvaluations = static_cast<std::size_t>(options.maxEvaluations),
            .progress = progress};
        Result result;
        if (form) {
            result.kept = represent(*brdf, *form, formOpener(), how);
            writeRepresentation(*result.kept, output);
            result.projection.coefficients = result.kept->head;
            return result;
        }
        const Basis* const one[] = {basis.get()};
        result.projection = options.leastSquares
                                ? projectSamples(*brdf, *basis, outgoing, options, progress)
                                : std::move(project(*brdf, one, outgoing, how)[0]);
        writeCoefficients(result.projection.coefficients, output);
        return result;
    }
};

void noteEnergy(const Projection& projection, const std::string& prefix, const Globals& globals) {
    const Energy& energy = projection.coefficients.energy;
    if (!energy.finite) note(globals, prefix + "the energy does not exist: " + energy.reason);
}

std::string line(const Result& result, const Json& document, const std::string& output) {
    const Coefficients& c = result.projection.coefficients;
    if (result.kept) {
        const std::string what =
            c.basis.empty() ? "" : fmt::format("{} order {}, ", c.basis, c.order);
        return fmt::format("{}: {}error {:.1e}\n{}", output, what, c.error, formLine(*result.kept));
    }
    if (const auto& fit = c.leastSquares) {
        return fmt::format(
            "{}: {} order {}, {} directions, least squares over {} samples, condition {:.2g}, "
            "residual {:.3g}\n",
            output, c.basis, c.order, c.outgoing.size(), fit->samples, fit->condition,
            fit->residual);
    }
    const std::string accuracy =
        document["accuracy"].is_null()
            ? "no captured energy"
            : fmt::format("{:.6f} of the energy captured", document["accuracy"].get<double>());
    return fmt::format("{}: {} order {}, {} directions, {}, quadrature error {:.1e}\n", output,
                       c.basis, c.order, c.outgoing.size(), accuracy, c.error);
}

void projectOne(const Job& job, const Globals& globals) {
    const std::string& output = job.options.output;
    Progress progress(globals, "project");
    const Result result = job.run(job.options.specs[0], output, progress.callback());
    noteEnergy(result.projection, "", globals);
    const Json document = answer(result, output);
    if (globals.json)
        printJson(document);
    else
        printText(line(result, document, output));
}

/// Every input to a file of its own in the folder `-o`.
void projectMany(const Job& job, Globals& globals) {
    const ProjectOptions& options = job.options;
    const std::vector<std::string> specs = expandInputs(options.specs);
    const std::vector<std::string> outputs =
        outputPaths(specs, options.output, "." + options.files);
    std::error_code error;
    std::filesystem::create_directories(options.output, error);
    if (error) {
        throw OutputError(fmt::format("{}: {}; -o of several inputs is a folder", options.output,
                                      error.message()));
    }
    std::vector<std::optional<Result>> results(specs.size());
    const std::vector<InputFailure> failures =
        forEachInput(specs, globals, "project", [&](std::size_t i, const ProgressCall& progress) {
            Result result = job.run(specs[i], outputs[i], progress);
            result.projection.coefficients.values = {};  // they are in the file
            results[i] = std::move(result);
        });
    Json documents = Json::array(), failed = Json::array();
    std::string text;
    for (std::size_t i = 0; i < specs.size(); ++i) {
        if (!results[i]) continue;
        const Projection& projection = results[i]->projection;
        noteEnergy(projection, projection.coefficients.source + ": ", globals);
        documents.push_back(answer(*results[i], outputs[i]));
        text += line(*results[i], documents.back(), outputs[i]);
    }
    for (const InputFailure& failure : failures)
        failed.push_back({{"spec", failure.spec}, {"reason", failure.reason}});
    if (globals.json)
        printJson({{"format", "hshfit-projects"},
                   {"version", 1},
                   {"projections", documents},
                   {"failures", failed}});
    else
        printText(text);
    reportFailures(failures, specs.size(), globals);
}

/// The form asked for; the default map is left to it where it needs none.
std::optional<Form> formOf(const ProjectOptions& options) {
    Form base;
    base.basis = options.basis;
    base.order = options.order;
    base.condonShortley = options.condonShortley;
    base.quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf;
    base.outgoing = options.outgoing;
    const auto form = options.form.build(std::move(base));
    if (form && options.leastSquares) {
        throw UsageError("--least-squares writes plain coefficients: leave out the form");
    }
    return form;
}

void runProject(const ProjectOptions& options, Globals& globals) {
    const Job job{
        options,
        bases::make(options.basis, options.order, {.condonShortley = options.condonShortley}),
        OutgoingSet::parse(options.outgoing.empty() ? defaultMap : options.outgoing),
        formOf(options)};
    if (areMany(options.specs))
        projectMany(job, globals);
    else
        projectOne(job, globals);
}

}  // namespace

void addProject(CLI::App& command, Globals& globals) {
    auto options = std::make_shared<ProjectOptions>();
    command
        .add_option("SPEC", options->specs,
                    "One or more BRDFs; of a folder, the measured files in it")
        ->required();
    command
        .add_option("-o,--output", options->output,
                    "Coefficient file, .json or .exr; for many BRDFs, the folder for their files")
        ->required();
    command.add_option("--files", options->files, "With many BRDFs: json or exr")
        ->check(CLI::IsMember({"json", "exr"}))
        ->capture_default_str();
    command.add_option("--basis", options->basis, "See hshfit list bases")->capture_default_str();
    command.add_option("--order", options->order, "Number of bands: l = 0 .. order-1")
        ->capture_default_str();
    command
        .add_option("--outgoing", options->outgoing,
                    "WxH (parabolic map), N (elevations, isotropic) or THETA,PHI in degrees")
        ->default_str(defaultMap);
    addRgb(command, options->rgb);
    command.add_flag("--cosine", options->cosine, "Project f cos(theta_i) instead of f");
    command.add_flag("--condon-shortley", options->condonShortley,
                     "Give functions of odd m the Condon-Shortley sign");
    command
        .add_option("--tolerance", options->tolerance,
                    "Relative agreement of two quadrature levels (default: 1e-6, tables 3e-3)")
        ->check(CLI::Range(1e-13, 1.0));
    command
        .add_option("--max-evaluations", options->maxEvaluations,
                    "BRDF evaluations per outgoing direction before giving up")
        ->check(CLI::Range(1e3, 1e12))
        ->capture_default_str();
    command.add_flag("--least-squares", options->leastSquares,
                     "Fit scattered samples themselves, not the interpolation between them");
    command
        .add_option("--regularise", options->regularise,
                    "With --least-squares: Tikhonov weight, relative to the system's own scale")
        ->check(CLI::Range(0.0, 1e3))
        ->capture_default_str();
    command
        .add_option("--kernel", options->kernel,
                    "With --least-squares: degrees about an outgoing direction that count at most")
        ->check(CLI::Range(0.1, 180.0))
        ->capture_default_str();
    options->form.addTo(command);
    command.callback([options, &globals] { runProject(*options, globals); });
}

}  // namespace hshfit::cli
