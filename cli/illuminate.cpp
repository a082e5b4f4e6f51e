#include "cache_options.h"
#include "command.h"
#include "within.h"

#include <hshfit/error.h>
#include <hshfit/percent.h>

#include <jobs/scenes/illuminate.h>
#include <jobs/source/quality.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

struct IlluminateArguments {
    std::string scene, output, method = "path";
    double stops = 0;
    jobs::IlluminateOptions options;
    CacheArguments cache;
};

std::string textOf(const jobs::LitMaterial& material) {
    if (material.way == LightWay::irradiance)
        return fmt::format("  {}: diffuse, irradiance\n", material.name);
    std::string text;
    if (material.way == LightWay::coefficients) {
        text = fmt::format("  {}: coefficients of order {}, {} of the energy lost\n", material.name,
                           material.order, percent(material.loss, 2));
    } else {
        text =
            fmt::format("  {}: sampled, {}\n", material.name,
                        material.reason.empty() ? percent(material.loss, 2) + " of the energy lost"
                                                : material.reason);
    }
    if (!material.cost) return text;
    return text + fmt::format(
                      "    predicted: {:.2g} s of CPU by records, {:.2g} s by sampling with "
                      "{} walks a line of sight\n",
                      material.cost->cacheSeconds, material.cost->samplingSeconds,
                      material.cost->walks);
}

std::string errorText(const jobs::IlluminatedCamera& camera) {
    if (!camera.standardError) return "no standard error";
    return fmt::format("standard error of a pixel {} of it, at most {} at ({}, {})",
                       percent(*camera.standardError, 2), percent(*camera.largestError, 2),
                       camera.errorColumn, camera.errorRow);
}

std::string textOf(const jobs::IlluminatedCamera& camera) {
    std::string text = fmt::format(
        "{}: {} x {}, mean radiance {:.4g}, {}, {:.3g} rays, {:.1f} s "
        "({:.1f} s of CPU)\n",
        camera.name, camera.width, camera.height, camera.mean, errorText(camera),
        static_cast<double>(camera.rays), camera.seconds, camera.cpuSeconds);
    if (camera.resumedRows > 0)
        text += fmt::format("  {} rows of an earlier run were taken\n", camera.resumedRows);
    if (camera.records) {
        text += fmt::format("  {} records, {} of them new, {:.2f} MB; {} samples out of reach\n",
                            *camera.records, *camera.made, static_cast<double>(*camera.bytes) / 1e6,
                            camera.uncovered);
    }
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
    if (globals.json) return printJson(jobs::illuminateJson(done, arguments.method));
    std::string text = fmt::format(
        "{}: {} triangles{}, prepared in {:.1f} s\n", done.scene, done.triangles,
        done.degenerate > 0 ? fmt::format(" and {} without area, left out", done.degenerate) : "",
        done.preparationSeconds);
    for (const jobs::LitMaterial& material : done.materials) text += textOf(material);
    for (const jobs::IlluminatedCamera& camera : done.cameras) text += textOf(camera);
    printText(text);
}

/// Settings of the method.
void choose(IlluminateArguments& arguments, bool samplesGiven) {
    if (arguments.method == "path") return refuseCacheOptions(arguments.cache, arguments.method);
    arguments.options.cache = cacheOptionsOf(arguments.cache);
    arguments.options.chooseByCost = arguments.cache.choice == "cost";
    if (!samplesGiven) arguments.options.path.samples = 16;
    if (arguments.options.resume)
        throw UsageError("--resume is for --method path; records are kept by --records FILE");
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
    command
        .add_option("--method", arguments->method,
                    "path: path tracing; radiance-cache: records of incident light on surfaces, "
                    "by coefficients")
        ->check(CLI::IsMember({"path", "radiance-cache"}))
        ->capture_default_str();
    command.add_option("--camera", options.camera, "Take this one alone (default: all)");
    auto* samples =
        command
            .add_option(
                "--samples", options.path.samples,
                "Paths, or lines of sight, through each pixel (default: 64; radiance-cache: "
                "16)")
            ->check(within(jobs::bounds::pathSamples));
    command.add_option("--bounces", options.path.mostBounces, "Reflections after which paths end")
        ->check(within(jobs::bounds::mostBounces))
        ->capture_default_str();
    command
        .add_option("--from-bounce", options.path.fewestBounces,
                    "Leave out light of fewer reflections: 1 what is seen directly, 2 direct light "
                    "too")
        ->check(within(jobs::bounds::fewestBounces))
        ->capture_default_str();
    command.add_option("--seed", options.path.seed, "Seed of the random numbers")
        ->capture_default_str();
    command.add_option("--reference", options.reference,
                       "OpenEXR picture that relative_mse is measured against; with one camera");
    auto* exposure = command.add_option("--exposure", arguments->stops,
                                        "Stops of the PNG files (default: automatic)");
    command.add_flag("--resume", options.resume,
                     "Keep finished rows in OUTPUT/.hshfit-CAMERA.partial until the picture is "
                     "written, and go on from those of a run that was stopped");
    command.add_flag("--force", options.force, "Replace existing files");
    addCacheOptions(command, arguments->cache);
    arguments->cache.all.push_back(command.add_option(
        "--records", options.records,
        "File of records: read if it stands, and written with those that are added"));
    command.callback([arguments, exposure, samples, &globals] {
        choose(*arguments, samples->count() > 0);
        if (exposure->count() > 0) arguments->options.stops = arguments->stops;
        runIlluminate(*arguments, globals);
    });
}

}  // namespace hshfit::cli
