#include "export_three.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/highlight.h>
#include <hshfit/gpu/three/three_files.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace hshfit::jobs {

void writeThree(const Brdf& brdf, const ExportOptions& options, const Listener& listener,
                FileSet& files, Exported& exported) {
    const bool measured = exported.error.split || exported.error.loss;
    gpu::ThreeOptions three{
        .name = exported.name,
        .shader = options.shader,
        .storage = exported.storage,
        .roughness = gpu::highlightRoughness(brdf),
        .fitError = measured ? jsonText(errorJson(exported.error)) : std::string()};
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
