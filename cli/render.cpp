#include "command.h"
#include "within.h"

#include <hshfit/error.h>

#include <jobs/scenes/render.h>
#include <jobs/scenes/render_json.h>
#include <jobs/scenes/spheres.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hshfit::cli {
namespace {

using By = jobs::RenderOptions::By;
using Kind = jobs::RenderedPicture::Kind;

constexpr const char* exposuresOption = "--exposures";

struct RenderArguments {
    std::vector<std::string> specs, lights, bases, exposures;
    std::vector<int> orders;
    std::string output, exposure = "auto", mesh, up = "y", by = "both", view = "75,0", outgoing;
    int size = SphereOptions{}.size, samples = 0;
    double fieldOfView = 0, dome = SphereRig{}.dome;
    std::optional<double> tolerance, seconds;
    bool cosine = false;
    /// Whether an option was given that the spheres under point lights do not have.
    bool surface = false, domeGiven = false;
};

/// "THETA,PHI" or "THETA,PHI,STRENGTH".
SphereLight parseLight(const std::string& text) {
    const char *at = text.data(), *end = at + text.size();
    double numbers[3] = {0, 0, 1};
    int count = 0;
    for (bool more = true; more && count < 3; ++count) {
        const auto [next, error] = std::from_chars(at, end, numbers[count]);
        if (error != std::errc() || !std::isfinite(numbers[count])) break;
        more = next != end && *next == ',';
        at = more ? next + 1 : next;
    }
    if (at != end || count < 2 || text.back() == ',' || !(numbers[0] >= 0) ||
        !(numbers[0] <= 180) || !(numbers[2] >= 0)) {
        throw UsageError(fmt::format(
            "--light '{}': give THETA,PHI or THETA,PHI,STRENGTH: degrees from the line of sight "
            "(0 to 180), degrees from the right counterclockwise, strength (for example 45,135,1); "
            "or a kind of light or the path of a picture",
            text));
    }
    return {directionFromAngles(radians(numbers[0]), radians(numbers[1])), numbers[2]};
}

/// Whether a light begins like numbers; others are kinds of light and paths.
bool isNumbers(const std::string& text) {
    double first = 0;
    const char* end = text.data() + text.size();
    const auto [next, error] = std::from_chars(text.data(), end, first);
    if (error != std::errc() || (next != end && *next != ',')) return text.size() < 2;
    return true;
}

double parseStops(const std::string& text, std::string_view option, std::string_view valid) {
    double stops = 0;
    const char* end = text.data() + text.size();
    const char* begin = text.starts_with('+') ? text.data() + 1 : text.data();
    const auto [next, error] = std::from_chars(begin, end, stops);
    if (error != std::errc() || next != end || !(std::abs(stops) <= 100)) {
        throw UsageError(fmt::format("{} '{}': give {} (for example -1.5)", option, text, valid));
    }
    return stops;
}

/// Stops; none for "auto".
std::optional<double> parseExposure(const std::string& text) {
    if (text == "auto") return {};
    return parseStops(text, "--exposure", "auto or stops");
}

/// The direction to the viewer, degrees: "THETA,PHI", theta from the zenith to 180.
std::vector<double> parseView(const std::string& text) {
    constexpr std::string_view form =
        "THETA,PHI, degrees from the zenith (0 to 180) and from +x towards +y (for example 75,0)";
    auto angles = parseNumbers(text, 2, "--view", form);
    if (!(angles[0] >= 0 && angles[0] <= 180))
        throw UsageError(fmt::format("--view '{}': give {}", text, form));
    return angles;
}

// --- spheres under point lights ---------------------------------------------------------------

void runSpheres(const RenderArguments& arguments, const Globals& globals) {
    jobs::SphereSheetOptions options;
    options.size = arguments.size;
    options.stops = parseExposure(arguments.exposure);
    options.rig.dome = arguments.dome;
    if (!arguments.lights.empty()) options.rig.lights.clear();
    for (const auto& light : arguments.lights) options.rig.lights.push_back(parseLight(light));
    if (arguments.samples > 0) options.samples = arguments.samples;
    const jobs::SphereSheet sheet =
        jobs::renderSpheres(arguments.specs, arguments.output, options, listenerFor(globals));
    if (globals.json) {
        printJson(jobs::spheresJson(sheet, options, arguments.output));
    } else {
        printText(fmt::format("{}: {} sphere{} of {} x {} pixels, exposure {:+.1f} stops\n",
                              arguments.output, sheet.spheres.size(),
                              sheet.spheres.size() == 1 ? "" : "s", options.size, options.size,
                              sheet.stops));
    }
}

// --- surfaces under any light -----------------------------------------------------------------

jobs::RenderOptions optionsOf(const RenderArguments& arguments) {
    jobs::RenderOptions options;
    for (const std::string& light : arguments.lights) {
        if (isNumbers(light))
            options.rig.lights.push_back(parseLight(light));
        else
            options.lights.push_back(light);
    }
    if (arguments.lights.empty()) options.rig = SphereRig{};
    if (arguments.domeGiven || options.lights.empty()) options.rig.dome = arguments.dome;
    options.mesh = arguments.mesh;
    options.meshYUp = arguments.up == "y";
    options.by = arguments.by == "both"          ? By::both
                 : arguments.by == "integration" ? By::integration
                                                 : By::coefficients;
    if (!arguments.bases.empty()) options.bases = arguments.bases;
    if (!arguments.orders.empty()) options.orders = arguments.orders;
    options.cosine = arguments.cosine;
    options.outgoing = arguments.outgoing;
    if (!arguments.exposures.empty()) options.exposures.clear();
    for (const std::string& text : arguments.exposures) {
        options.exposures.push_back(parseStops(text, exposuresOption, "stops"));
    }
    options.stops = parseExposure(arguments.exposure);
    options.size = arguments.size;
    if (arguments.samples > 0) options.samples = arguments.samples;
    const auto view = parseView(arguments.view);
    options.viewTheta = view[0];
    options.viewPhi = view[1];
    options.fieldOfView = arguments.fieldOfView;
    options.tolerance = arguments.tolerance;
    options.seconds = arguments.seconds;
    return options;
}

std::string surfaceText(const RenderArguments& arguments, const jobs::Rendered& rendered) {
    std::string text = fmt::format("{}: {} picture{} of {} x {} pixels, exposure {:+.1f} stops\n",
                                   arguments.output, rendered.pictures.size(),
                                   rendered.pictures.size() == 1 ? "" : "s", arguments.size,
                                   arguments.size, rendered.stops);
    for (const auto& picture : rendered.pictures) {
        text += fmt::format("  {},{}  {}  {}", picture.column, picture.row, picture.brdf,
                            jobs::kindName(picture.kind));
        if (!picture.basis.empty()) text += fmt::format(" {} {}", picture.basis, picture.order);
        if (picture.exposure != 0) text += fmt::format(" {:+g} stops", picture.exposure);
        if (picture.kind == Kind::difference) {
            text += fmt::format(
                " x {:g}: relative L2 {:.4f}, at most {:.3f} of the mean radiance "
                "{:.4g}",
                picture.amplification, picture.difference->relativeL2, picture.difference->maximum,
                picture.difference->meanRadiance);
        } else if (picture.kind == Kind::integration) {
            text += fmt::format(": error {:.2g}, of a pixel at most {:.2g} at {},{}", picture.error,
                                picture.largest.error, picture.largest.column, picture.largest.row);
        }
        text += "\n";
    }
    return text;
}

void runSurface(const RenderArguments& arguments, Globals& globals) {
    const jobs::RenderOptions options = optionsOf(arguments);
    const jobs::Rendered rendered =
        jobs::render(arguments.specs, arguments.output, options, listenerFor(globals));
    if (globals.json)
        printJson(jobs::renderJson(rendered, options, arguments.output));
    else
        printText(surfaceText(arguments, rendered));
}

void runRender(const RenderArguments& arguments, Globals& globals) {
    if (arguments.surface || !std::ranges::all_of(arguments.lights, isNumbers)) {
        runSurface(arguments, globals);
    } else {
        runSpheres(arguments, globals);
    }
}

/// The options of surfaces under any light; `surface` becomes true with each of them.
void addSurfaceOptions(CLI::App& command, RenderArguments& arguments) {
    const auto given = [&arguments](auto&&...) { arguments.surface = true; };
    command
        .add_option("--mesh", arguments.mesh, "OBJ, PLY or glTF file in the place of the sphere")
        ->each(given);
    command.add_option("--up", arguments.up, "The mesh's axis that points up")
        ->check(CLI::IsMember({"y", "z"}))
        ->capture_default_str();
    command.add_option("--view", arguments.view, "THETA,PHI: the direction to the viewer, degrees")
        ->capture_default_str()
        ->each(given);
    command
        .add_option("--field-of-view", arguments.fieldOfView,
                    "Degrees from edge to edge of a perspective picture (default: lines of sight "
                    "are parallel)")
        ->check(within(jobs::bounds::fieldOfView))
        ->each(given);
    command.add_option("--by", arguments.by, "The way in which light and material meet")
        ->check(CLI::IsMember({"coefficients", "integration", "both"}))
        ->capture_default_str()
        ->each(given);
    command
        .add_option("--basis,--bases", arguments.bases,
                    "Bases of the coefficients, a column each (default: hsh)")
        ->delimiter(',')
        ->each(given);
    command
        .add_option("--order,--orders", arguments.orders,
                    "Their numbers of bands, a column each (default: 10)")
        ->delimiter(',')
        ->each(given);
    command.add_flag("--cosine", arguments.cosine, "Coefficients of f cos(theta_i)");
    command.add_option("--outgoing", arguments.outgoing,
                       "Outgoing directions of the coefficients, interpolated in between "
                       "(default: 64 if isotropic, else 48x48)");
    command.add_option(exposuresOption, arguments.exposures, "Stops, a column each: -2,0,2")
        ->delimiter(',')
        ->each(given);
    command
        .add_option("--tolerance,--error", arguments.tolerance,
                    "Bound of the integration's error, as 1% or 0.01 (default: 5% by integration "
                    "alone, 0.5% beside coefficients)")
        ->transform(percents())
        ->check(within(jobs::bounds::pictureTolerance));
    command
        .add_option("--seconds", arguments.seconds,
                    "End integration after that time with the best picture so far, after a first "
                    "pass over all pixels to an error of 50% (default: no end)")
        ->check(within(jobs::bounds::seconds))
        ->each(given);
}

}  // namespace

void addRender(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<RenderArguments>();
    command
        .add_option("SPEC", arguments->specs,
                    "One or more BRDFs or coefficient files; of a folder, those in it")
        ->required();
    command.add_option("-o,--output", arguments->output, "Picture to write, .png or .exr")
        ->required();
    command.add_option("--size", arguments->size, "Pixels along a picture's square")
        ->check(within(jobs::bounds::pictureSize))
        ->capture_default_str();
    command
        .add_option("--samples", arguments->samples,
                    "N: N x N samples a pixel (default: 3; 2 under other than point lights)")
        ->check(within(jobs::bounds::pictureSamples));
    command
        .add_option("--light", arguments->lights,
                    "A light, sky or picture, added up with '+'; or THETA,PHI[,STRENGTH] in "
                    "degrees about the line of sight; again for more lights (default: 45,135,1 "
                    "and 75,-30,0.25)")
        ->allow_extra_args(false);
    command
        .add_option("--dome", arguments->dome,
                    "Radiance from all around (default: 0.1 with point lights, else 0)")
        ->check(within(jobs::bounds::dome))
        ->each([arguments](auto&&...) { arguments->domeGiven = true; });
    command.add_option("--exposure", arguments->exposure, "auto or stops; for .png only")
        ->capture_default_str();
    addSurfaceOptions(command, *arguments);
    command.callback([arguments, &globals] { runRender(*arguments, globals); });
}

}  // namespace hshfit::cli
