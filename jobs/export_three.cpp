#include "export_three.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/three/three_files.h>
#include <hshfit/lighting/lighting_shader.h>
#include <hshfit/lighting/prefiltered_lobes.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace hshfit::jobs {
namespace {

/// Lookups in the environment of three.js, besides the diffuse one two, or three for a lobe that
/// may be long.
gpu::ThreeLookUps lookUpsOf(const Brdf& brdf, const std::string& prefix, const std::string& name) {
    const lighting::Prefilter& engine = lighting::prefilterNamed("three");
    const lighting::PrefilteredTable fitted =
        lighting::fitPrefiltered(brdf, engine, brdf.laws().isotropic ? 2 : 3);
    const lighting::ElevationTable& table = fitted.table;
    const lighting::LightingShader shader{.kind = lighting::LightingShader::Kind::prefiltered,
                                          .engine = &engine,
                                          .lobes = fitted.lobes,
                                          .inPlane = fitted.inPlane,
                                          .rows = table.rows,
                                          .azimuths = table.azimuths,
                                          .texels = table.texels,
                                          .prefix = prefix,
                                          .source = name,
                                          .generator = std::string("hshfit ") + version};
    gpu::ThreeLookUps lookUps{.wgsl = lighting::lightingShaderSource(gpu::Language::wgsl, shader),
                              .glsl = lighting::lightingShaderSource(gpu::Language::glslEs, shader),
                              .texels = {table.values.begin(), table.values.end()},
                              .width = table.texels,
                              .height = table.height(),
                              .along = table.azimuths.count > 1};
    for (const std::vector<double>& bands : lighting::levelBands(engine, 3)) {
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
        three.lookUps = lookUpsOf(brdf, options.shader.prefix, exported.name);
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
