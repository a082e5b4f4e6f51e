#include "command.h"
#include "documents.h"

#include <hshfit/error.h>
#include <hshfit/pictures/sphere_picture.h>

#include <jobs/source.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <charconv>
#include <cmath>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct RenderArguments {
    std::vector<std::string> specs, lights;
    std::string output, exposure = "auto";
    int size = SphereOptions{}.size, samples = SphereOptions{}.samples;
    double dome = SphereRig{}.dome;
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
            "(0 to 180), degrees from the right counterclockwise, strength (for example 45,135,1)",
            text));
    }
    return {directionFromAngles(radians(numbers[0]), radians(numbers[1])), numbers[2]};
}

/// Stops; none for "auto".
std::optional<double> parseExposure(const std::string& text) {
    if (text == "auto") return {};
    double stops = 0;
    const char* end = text.data() + text.size();
    const auto [next, error] = std::from_chars(text.data(), end, stops);
    if (error != std::errc() || next != end || !(std::abs(stops) <= 100)) {
        throw UsageError(
            fmt::format("--exposure '{}': give auto or stops (for example -1.5)", text));
    }
    return stops;
}

Json lightsJson(const SphereRig& rig) {
    Json lights = Json::array();
    for (const SphereLight& light : rig.lights) {
        Json json = directionJson(light.towards);
        json["strength"] = light.strength;
        lights.push_back(json);
    }
    return lights;
}

void runRender(const RenderArguments& arguments, Globals& globals) {
    checkSpheresPath(arguments.output);
    SphereOptions options{.size = arguments.size, .samples = arguments.samples};
    options.rig.dome = arguments.dome;
    if (!arguments.lights.empty()) options.rig.lights.clear();
    for (const auto& light : arguments.lights) options.rig.lights.push_back(parseLight(light));
    const std::optional<double> stops = parseExposure(arguments.exposure);

    std::vector<SpherePicture> spheres;
    std::map<std::string, std::string> attributes;
    Json document = {{"format", "hshfit-render"},    {"version", 1},
                     {"output", arguments.output},   {"size", arguments.size},
                     {"samples", arguments.samples}, {"lights", lightsJson(options.rig)},
                     {"dome", options.rig.dome}};
    Json list = Json::array();
    for (const auto& spec : arguments.specs) {
        const auto brdf = jobs::openSource(spec, /*rgb=*/false);
        Progress progress(globals, brdf->name());
        options.progress = progress.callback();
        spheres.push_back(renderSphere(*brdf, options));
        brdf->checkIntact();
        const std::size_t column = (spheres.size() - 1) * static_cast<std::size_t>(options.size);
        list.push_back({{"brdf", brdf->name()},
                        {"column", column},
                        {"colours", spheres.back().colours},
                        {"not_finite", spheres.back().notFinite}});
        attributes[fmt::format("hshfit:sphere{}", spheres.size())] = brdf->name();
        if (spheres.back().notFinite > 0) {
            note(globals, fmt::format("{}: {} values that are not finite were left out",
                                      brdf->name(), spheres.back().notFinite));
        }
    }
    const double shown = stops ? *stops : automaticExposure(spheres);
    writeSpheres(spheres, shown, arguments.output, attributes);
    document["exposure"] = {{"automatic", !stops}, {"stops", shown}};
    document["spheres"] = list;
    if (globals.json) {
        printJson(document);
    } else {
        printText(fmt::format("{}: {} sphere{} of {} x {} pixels, exposure {:+.1f} stops\n",
                              arguments.output, spheres.size(), spheres.size() == 1 ? "" : "s",
                              options.size, options.size, shown));
    }
}

}  // namespace

void addRender(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<RenderArguments>();
    command.add_option("SPEC", arguments->specs, "One or more BRDFs or coefficient files")
        ->required();
    command.add_option("-o,--output", arguments->output, "Picture to write, .png or .exr")
        ->required();
    command.add_option("--size", arguments->size, "Pixels along a sphere's square")
        ->check(CLI::Range(8, 4096))
        ->capture_default_str();
    command.add_option("--samples", arguments->samples, "N: N x N samples a pixel")
        ->check(CLI::Range(1, 16))
        ->capture_default_str();
    command
        .add_option("--light", arguments->lights,
                    "THETA,PHI[,STRENGTH] in degrees about the line of sight, again for more "
                    "lights (default: 45,135,1 and 75,-30,0.25)")
        ->allow_extra_args(false);
    command.add_option("--dome", arguments->dome, "Radiance from all around")
        ->check(CLI::Range(0.0, 1e6))
        ->capture_default_str();
    command.add_option("--exposure", arguments->exposure, "auto or stops; for .png only")
        ->capture_default_str();
    command.callback([arguments, &globals] { runRender(*arguments, globals); });
}

}  // namespace hshfit::cli
