#include "command.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/least_squares.h>
#include <hshfit/output/coefficient_file.h>
#include <hshfit/projection.h>

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/scattered.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ProjectOptions {
    std::string spec, output, basis = "hsh", outgoing = "32x32";
    int order = 7;
    bool cosine = false, condonShortley = false, rgb = false;
    double tolerance = 0;
    bool leastSquares = false;
    double regularise = 1e-3, kernel = 20;
    double maxEvaluations = static_cast<double>(ProjectionOptions{}.maxEvaluations);
};

Json answer(const Projection& projection, const std::string& output) {
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
    return document;
}

/// Scattered samples straight to coefficients, without interpolating between them.
Projection projectSamples(const Brdf& brdf, const Basis& basis, const OutgoingSet& outgoing,
                          const ProjectOptions& options,
                          std::function<void(std::size_t, std::size_t)> progress) {
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

void runProject(const ProjectOptions& options, const Globals& globals) {
    const auto basis =
        bases::make(options.basis, options.order, {.condonShortley = options.condonShortley});
    const OutgoingSet outgoing = OutgoingSet::parse(options.outgoing);
    const auto brdf = openBrdf(options.spec, options.rgb);

    Progress progress(globals, "project");
    const Basis* const one[] = {basis.get()};
    const Projection projection =
        options.leastSquares
            ? projectSamples(*brdf, *basis, outgoing, options, progress.callback())
            : project(*brdf, one, outgoing,
                      {.quantity = options.cosine ? Quantity::brdfCosine : Quantity::brdf,
                       .tolerance = options.tolerance,
                       .maxEvaluations = static_cast<std::size_t>(options.maxEvaluations),
                       .progress = progress.callback()})[0];
    const Coefficients& coefficients = projection.coefficients;
    writeCoefficients(coefficients, options.output);

    if (!coefficients.energy.finite) {
        note(globals, "the energy does not exist: " + coefficients.energy.reason);
    }
    const Json document = answer(projection, options.output);
    if (globals.json) {
        printJson(document);
        return;
    }
    if (const auto& fit = coefficients.leastSquares) {
        printText(fmt::format(
            "{}: {} order {}, {} directions, least squares over {} samples, condition {:.2g}, "
            "residual {:.3g}\n",
            options.output, coefficients.basis, coefficients.order, coefficients.outgoing.size(),
            fit->samples, fit->condition, fit->residual));
        return;
    }
    const std::string accuracy =
        document["accuracy"].is_null()
            ? "no captured energy"
            : fmt::format("{:.6f} of the energy captured", document["accuracy"].get<double>());
    printText(fmt::format("{}: {} order {}, {} directions, {}, quadrature error {:.1e}\n",
                          options.output, coefficients.basis, coefficients.order,
                          coefficients.outgoing.size(), accuracy, coefficients.error));
}

}  // namespace

void addProject(CLI::App& app, Globals& globals) {
    auto options = std::make_shared<ProjectOptions>();
    CLI::App& command = addCommand(
        app, globals, "project", "Coefficients of a BRDF, per outgoing direction, to a file",
        "hshfit project ward:ax=.2,ay=.5 -o ward.json --basis hsh --order 7 --cosine");
    command.add_option("SPEC", options->spec, "BRDF")->required();
    command.add_option("-o,--output", options->output, "Coefficient file, .json or .exr")
        ->required();
    command.add_option("--basis", options->basis, "See hshfit list bases")->capture_default_str();
    command.add_option("--order", options->order, "Number of bands: l = 0 .. order-1")
        ->capture_default_str();
    command
        .add_option("--outgoing", options->outgoing,
                    "WxH (parabolic map), N (elevations, isotropic) or THETA,PHI in degrees")
        ->capture_default_str();
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
    command.callback([options, &globals] { runProject(*options, globals); });
}

}  // namespace hshfit::cli
