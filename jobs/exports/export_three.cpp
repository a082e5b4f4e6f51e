#include "export_three.h"

#include "look_ups.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/three/three_files.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace hshfit::jobs {
namespace {

gpu::ThreeLookUps threeLookUps(const Brdf& brdf, const std::string& prefix,
                               const std::string& name) {
    const LookUps made = lookUpsOf(brdf, "three", prefix, name);
    const lighting::ElevationTable& table = made.fitted.table;
    gpu::ThreeLookUps lookUps{
        .wgsl = lighting::lightingShaderSource(gpu::Language::wgsl, made.shader),
        .glsl = lighting::lightingShaderSource(gpu::Language::glslEs, made.shader),
        .texels = {table.values.begin(), table.values.end()},
        .width = table.texels,
        .height = table.height(),
        .along = table.azimuths.count > 1};
    for (const std::vector<double>& bands : lighting::levelBands(*made.fitted.engine, 3)) {
        lookUps.first.push_back(bands[1]);
        lookUps.second.push_back(bands[2]);
    }
    return lookUps;
}

}  // namespace

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
    for (const gpu::TextFile& file : made) {
        std::error_code ignored;
        const bool package = file.path == "package.json";
        if (package && !options.force &&
            std::filesystem::exists(files.folder() / file.path, ignored)) {
            listener.say("package.json is there already and stays as it is");
            continue;
        }
        files.write(file.path, file.text);
        exported.texts.push_back({"module", "three", file.path});
    }
}

}  // namespace hshfit::jobs
