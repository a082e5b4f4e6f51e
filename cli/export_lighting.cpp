#include "export_lighting.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

/// The error of a prefiltered environment over all turns of the light.
std::string turnedText(const Json& error) {
    return error.contains("turned_l2")
               ? fmt::format("; over all turns {:.4f}", error["turned_l2"].get<double>())
               : "";
}

std::string lightingText(const Json& answer) {
    std::string out =
        fmt::format("{}: lighting of {} under {}\n", answer["folder"].get<std::string>(),
                    answer["brdf"].get<std::string>(), answer["light"].get<std::string>());
    for (const Json& model : answer["models"])
        out +=
            fmt::format("  {:12}  table of {} bytes in {:.2g} s, light of {} bytes in {:.2g} s\n",
                        model["model"].get<std::string>(), model["bytes"].get<std::size_t>(),
                        model["seconds"].get<double>(), model["light_bytes"].get<std::size_t>(),
                        model["light_seconds"].get<double>());
    for (const Json& file : answer["files"]) out += "  " + file.get<std::string>() + "\n";
    if (answer["errors"].empty()) return out;
    out +=
        "against direct integration on a sphere: relative L2, FLIP, largest difference of a pixel\n"
        "over the mean radiance, nanoseconds of a point on one thread (direct integration: last)\n";
    for (const Json& error : answer["errors"])
        out += fmt::format("  {:12}  {:7.4f}  {:6.4f}  {:7.3f}  {:8.0f} {:10.0f}  {}{}\n",
                           error["model"].get<std::string>(), error["relative_l2"].get<double>(),
                           error["flip"].get<double>(), error["maximum"].get<double>(),
                           error["nanoseconds"].get<double>(),
                           error["integration_nanoseconds"].get<double>(),
                           error["light"].get<std::string>(), turnedText(error));
    return out;
}

}  // namespace

void requirePrefiltered(const CLI::App& command, const std::string& models) {
    const auto isIt = [](const jobs::LightingModel* model) {
        return model->kind == jobs::LightingModel::Kind::prefiltered;
    };
    if (!models.empty() && std::ranges::any_of(jobs::selectLightingModels(models), isIt)) return;
    for (const char* name : {"--engine", "--lobes"})
        if (command.get_option(name)->count() > 0)
            throw UsageError(fmt::format("export: {} goes with --lighting prefiltered", name));
}

void runExportLighting(const std::string& coefficients, const std::string& folder,
                       const jobs::LightingExportOptions& options, const Globals& globals) {
    const jobs::LightingExport exported =
        jobs::exportLighting(coefficients, folder, options, listenerFor(globals));
    const Json answer = jobs::lightingJson(exported, folder);
    if (globals.json)
        printJson(answer);
    else
        printText(lightingText(answer));
}

}  // namespace hshfit::cli
