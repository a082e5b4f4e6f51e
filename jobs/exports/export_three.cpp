#include "export_three.h"

#include "look_ups.h"

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <atomic>
#include <filesystem>

namespace hshfit::jobs {
namespace {

/// Lookups without their texels.
gpu::ThreeLookUps shadersOf(const LookUps& made) {
    gpu::ThreeLookUps lookUps{
        .wgsl = lighting::lightingShaderSource(gpu::Language::wgsl, made.shader),
        .glsl = lighting::lightingShaderSource(gpu::Language::glslEs, made.shader),
        .along = made.fitted.table.azimuths.count > 1};
    for (const std::vector<double>& bands : lighting::levelBands(*made.fitted.engine, 3)) {
        lookUps.first.push_back(bands[1]);
        lookUps.second.push_back(bands[2]);
    }
    return lookUps;
}

/// Environments of three.js by their number of levels, the shader's own first.
constexpr std::array engines{"three", "three-512"};

gpu::ThreeLookUps threeLookUps(const Brdf& brdf, const std::string& prefix,
                               const std::string& name) {
    gpu::ThreeLookUps lookUps;
    for (std::size_t i = 0; i < engines.size(); ++i) {
        const LookUps made = lookUpsOf(brdf, engines[i], prefix, name);
        const lighting::ElevationTable& table = made.fitted.table;
        if (i == 0) lookUps = shadersOf(made);
        lookUps.texels[i] = gpu::encode(table.values, static_cast<int>(table.texels),
                                        static_cast<int>(table.height()), 1, gpu::Number::float32);
    }
    return lookUps;
}

}  // namespace

gpu::ThreeLookUps threeLookUps(std::size_t materials,
                               const std::function<std::unique_ptr<Brdf>(std::size_t)>& open,
                               const std::string& prefix, const std::string& name,
                               const ProgressCall& progress) {
    std::vector<std::array<LookUps, engines.size()>> made(materials);
    std::atomic<std::size_t> done = 0;
    eachInParallel(materials, [&](std::size_t n) {
        const std::unique_ptr<Brdf> brdf = open(n);
        for (std::size_t i = 0; i < engines.size(); ++i)
            made[n][i] = lookUpsOf(*brdf, engines[i], prefix, name);
        if (progress) progress(++done, materials);
    });
    made.front().front().shader.materials = true;
    gpu::ThreeLookUps lookUps = shadersOf(made.front().front());
    for (std::size_t i = 0; i < engines.size(); ++i) {
        std::vector<double> rows;
        for (const auto& one : made) {
            const std::vector<double>& values = one[i].fitted.table.values;
            rows.insert(rows.end(), values.begin(), values.end());
        }
        lookUps.texels[i] = gpu::encode(rows, static_cast<int>(rows.size() / (4 * materials)),
                                        static_cast<int>(materials), 1, gpu::Number::float16);
    }
    return lookUps;
}

std::vector<std::string> writeThreeFiles(std::span<const gpu::TextFile> made, bool force,
                                         const Listener& listener, FileSet& files) {
    std::vector<std::string> paths;
    for (const gpu::TextFile& file : made) {
        std::error_code ignored;
        const bool package = file.path == "package.json";
        if (package && !force && std::filesystem::exists(files.folder() / file.path, ignored)) {
            listener.say("package.json is there already and stays as it is");
            continue;
        }
        files.write(file.path, file.text);
        paths.push_back(file.path);
    }
    return paths;
}

void writeThree(const Brdf& brdf, const ExportOptions& options, const Listener& listener,
                FileSet& files, Exported& exported) {
    const bool measured = exported.error.split || exported.error.loss;
    gpu::ThreeOptions three{
        .name = exported.name,
        .shader = options.shader,
        .storage = exported.storage,
        .fitError = measured ? jsonText(errorJson(exported.error)) : std::string()};
    // Other materials are refused below.
    if (const std::size_t channels = brdf.channels().count(); channels == 1 || channels == 3)
        three.lookUps = threeLookUps(brdf, options.shader.prefix, exported.name);
    if (!options.library.empty()) three.library = options.library;
    std::vector<gpu::TextFile> made;
    try {
        made = exported.form ? gpu::threeFiles(*exported.form, three)
                             : gpu::threeFiles(exported.payload, three);
    } catch (const UsageError& error) {
        if (options.targets != "all") throw;
        listener.say(fmt::format("left out: {}", error.what()));
        return;
    }
    for (const std::string& path : writeThreeFiles(made, options.force, listener, files))
        exported.texts.push_back({"module", "three", path});
}

}  // namespace hshfit::jobs
