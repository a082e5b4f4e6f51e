#include "command.h"
#include "documents.h"

#include <jobs/illuminate.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct IlluminateArguments {
    std::string scene, output, method = "path";
    double stops = 0;
    jobs::IlluminateOptions options;
};

Json cameraJson(const jobs::IlluminatedCamera& camera) {
    Json json = {{"camera", camera.name},
                 {"width", camera.width},
                 {"height", camera.height},
                 {"seconds", camera.seconds},
                 {"cpu_seconds", camera.cpuSeconds},
                 {"rays", camera.rays},
                 {"records", nullptr},
                 {"bytes", nullptr},
                 {"mean", camera.mean},
                 {"standard_error", camera.standardError},
                 {"largest_error",
                  {{"relative", camera.largestError},
                   {"column", camera.errorColumn},
                   {"row", camera.errorRow}}},
                 {"cut", camera.cut},
                 {"exposure", camera.stops},
                 {"files", camera.files}};
    if (camera.reference) {
        json["relative_mse"] = camera.reference->relativeMse;
        json["maximum"] = {{"relative_square", camera.reference->maximum},
                           {"column", camera.reference->column},
                           {"row", camera.reference->row}};
    }
    return json;
}

std::string textOf(const jobs::IlluminatedCamera& camera) {
    std::string text = fmt::format(
        "{}: {} x {}, mean radiance {:.4g}, standard error of a pixel {:.2g} % of it, at most "
        "{:.2g} % at ({}, {}), {:.3g} rays, {:.1f} s ({:.1f} s of CPU)\n",
        camera.name, camera.width, camera.height, camera.mean, 100 * camera.standardError,
        100 * camera.largestError, camera.errorColumn, camera.errorRow,
        static_cast<double>(camera.rays), camera.seconds, camera.cpuSeconds);
    if (camera.cut > 0) text += fmt::format("  {} paths were cut\n", camera.cut);
    if (camera.reference) {
        text += fmt::format("  relative mean square error {:.3g}, at most {:.3g} at ({}, {})\n",
                            camera.reference->relativeMse, camera.reference->maximum,
                            camera.reference->column, camera.reference->row);
    }
    for (const std::string& file : camera.files) text += fmt::format("  {}\n", file);
    return text;
}

void runIlluminate(IlluminateArguments& arguments, const Globals& globals) {
    const jobs::Illuminated done = jobs::illuminate(arguments.scene, arguments.output,
                                                    arguments.options, listenerFor(globals));
    if (globals.json) {
        Json cameras = Json::array();
        for (const jobs::IlluminatedCamera& camera : done.cameras)
            cameras.push_back(cameraJson(camera));
        return printJson({{"format", "hshfit-illuminate"},
                          {"version", 1},
                          {"scene", done.scene},
                          {"method", arguments.method},
                          {"triangles", done.triangles},
                          {"degenerate", done.degenerate},
                          {"preparation_seconds", done.preparationSeconds},
                          {"cameras", cameras}});
    }
    std::string text = fmt::format(
        "{}: {} triangles{}, prepared in {:.1f} s\n", done.scene, done.triangles,
        done.degenerate > 0 ? fmt::format(" and {} without area, left out", done.degenerate) : "",
        done.preparationSeconds);
    for (const jobs::IlluminatedCamera& camera : done.cameras) text += textOf(camera);
    printText(text);
}

}  // namespace

void addIlluminate(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<IlluminateArguments>();
    jobs::IlluminateOptions& options = arguments->options;
    command
        .add_option("SCENE", arguments->scene, "Materials, objects, lights and cameras, as JSON")
        ->required();
    command
        .add_option("-o,--output", arguments->output,
                    "Folder for the pictures: CAMERA.exr, with standard errors, and CAMERA.png")
        ->required();
    command.add_option("--method", arguments->method, "path: path tracing")
        ->check(CLI::IsMember({"path"}))
        ->capture_default_str();
    command.add_option("--camera", options.camera, "Take this one alone (default: all)");
    command.add_option("--samples", options.path.samples, "Paths through each pixel")
        ->check(CLI::Range(1, 1 << 24))
        ->capture_default_str();
    command.add_option("--bounces", options.path.mostBounces, "Reflections after which paths end")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
    command
        .add_option("--from-bounce", options.path.fewestBounces,
                    "Leave out light of fewer reflections: 1 what is seen directly, 2 direct light "
                    "too")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    command.add_option("--seed", options.path.seed, "Seed of the random numbers")
        ->capture_default_str();
    command.add_option("--reference", options.reference,
                       "OpenEXR picture that relative_mse is measured against; with one camera");
    auto* exposure = command.add_option("--exposure", arguments->stops,
                                        "Stops of the PNG files (default: automatic)");
    command.add_flag("--force", options.force, "Replace existing files");
    command.callback([arguments, exposure, &globals] {
        if (exposure->count() > 0) arguments->options.stops = arguments->stops;
        runIlluminate(*arguments, globals);
    });
}

}  // namespace hshfit::cli
