#include "command.h"
#include "command_rows.h"
#include "job_options.h"

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
    std::string scene, output;
    jobs::IlluminateOptions options;
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

void runIlluminate(const IlluminateArguments& arguments, const Globals& globals) {
    const jobs::Illuminated done = jobs::illuminate(arguments.scene, arguments.output,
                                                    arguments.options, listenerFor(globals));
    if (globals.json) return printJson(jobs::illuminateJson(done));
    std::string text = fmt::format(
        "{}: {} triangles{}, prepared in {:.1f} s\n", done.scene, done.triangles,
        done.degenerate > 0 ? fmt::format(" and {} without area, left out", done.degenerate) : "",
        done.preparationSeconds);
    for (const jobs::LitMaterial& material : done.materials) text += textOf(material);
    for (const jobs::IlluminatedCamera& camera : done.cameras) text += textOf(camera);
    printText(text);
}

jobs::IlluminateMethod otherThan(jobs::IlluminateMethod method) {
    using enum jobs::IlluminateMethod;
    return method == path ? radianceCache : path;
}

/// Throws UsageError for an option of the other method.
void refuseMisplaced(const CLI::App& command, jobs::IlluminateMethod method) {
    for (const auto rows : illuminateRows().options)
        if (const auto given = misplacedOption(command, rows, jobs::illuminateBit(method)))
            throw UsageError(fmt::format("{} is for --method {}, not {}", given->name,
                                         jobs::nameOf(otherThan(method)), jobs::nameOf(method)));
}

constexpr ArgumentRow illuminateArguments[] = {
    required("SCENE", at<&IlluminateArguments::scene>,
             "Materials, objects, lights and cameras, as JSON", {.files = Files::read}),
    requiredOutput(at<&IlluminateArguments::output>,
                   "Folder for the pictures: CAMERA.exr, with standard errors, and CAMERA.png",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows illuminateRows() {
    return {illuminateArguments, {jobs::illuminateOptions().rows, jobs::cacheOptions().rows}};
}

void addIlluminate(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<IlluminateArguments>();
    addArguments(command, illuminateArguments, *arguments);
    addOptions(command, jobs::illuminateOptions(), arguments->options);
    addOptions(command, jobs::cacheOptions(), arguments->options, "Radiance cache");
    command.callback([arguments, &globals, &command] {
        refuseMisplaced(command, arguments->options.method);
        runIlluminate(*arguments, globals);
    });
}

}  // namespace hshfit::cli
