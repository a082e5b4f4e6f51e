#include "export_engine.h"

#include "look_ups.h"

#include <hshfit/error.h>
#include <hshfit/gpu/engines/engine_files.h>
#include <hshfit/gpu/viewer_light.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::jobs {
namespace {

const CoefficientHead& headOf(const Exported& exported) {
    return exported.form ? exported.form->form.head : exported.payload.head;
}

/// A shader of the scene cannot bind a uniform block of ours.
gpu::Storage storageOf(const Exported& exported) {
    return exported.storage == gpu::Storage::block ? gpu::Storage::texture : exported.storage;
}

void setSnippet(gpu::Language language, const Exported& exported, const ExportOptions& options,
                gpu::EngineMaterial& material) {
    const std::string& prefix = options.shader.prefix;
    if (exported.form) {
        const gpu::Storage storage = storageOf(exported);
        material.snippet =
            gpu::formShaderSource(language, *exported.form, {.prefix = prefix, .storage = storage});
        material.fetched = true;
        if (storage == gpu::Storage::texture)
            material.texels = gpu::samplerTexels(exported.form->texels);
    } else {
        gpu::ShaderOptions shader = options.shader;
        shader.environmentOrder = 0;
        material.snippet = gpu::shaderSource(language, exported.payload, shader);
        material.texels = gpu::samplerTexels(exported.payload.coefficients);
        material.cosine = exported.payload.head.quantity == Quantity::brdfCosine;
    }
}

void setLookUps(const gpu::EngineFile& row, const Brdf& brdf, gpu::EngineMaterial& material) {
    const LookUps made = lookUpsOf(brdf, row.prefilter, material.prefix, material.name);
    const lighting::ElevationTable& table = made.fitted.table;
    material.lookUps = lighting::lightingShaderSource(row.language, made.shader);
    material.along = table.azimuths.count > 1;
    material.lookUpTexels = {table.values.begin(), table.values.end()};
    material.lookUpWidth = table.texels;
    material.lookUpHeight = table.height();
}

std::string textOf(const gpu::EngineFile& row, const Brdf& brdf, const ExportOptions& options,
                   const Exported& exported) {
    const CoefficientHead& head = headOf(exported);
    if (head.channels.kind == Channels::Kind::spectral) {
        throw UsageError(
            fmt::format("{}{}: a material of {} is grey or RGB; project the spectral BRDF with {}",
                        exported.name, row.suffix, row.target, Call{.function = "asRgb"}));
    }
    gpu::EngineMaterial material{
        .name = exported.name,
        .title = head.source.empty() ? "Material" : gpu::shownName(head.source),
        .prefix = options.shader.prefix};
    setSnippet(row.language, exported, options, material);
    const std::size_t channels = brdf.channels().count();
    if (!row.prefilter.empty() && (channels == 1 || channels == 3)) setLookUps(row, brdf, material);
    return gpu::engineFile(row, material);
}

}  // namespace

bool hasEngineFile(std::string_view target) {
    return std::ranges::any_of(gpu::engineFiles(),
                               [&](const gpu::EngineFile& row) { return row.target == target; });
}

void writeEngine(std::string_view target, const Brdf& brdf, const ExportOptions& options,
                 const Listener& listener, FileSet& files, Exported& exported) {
    for (const gpu::EngineFile& row : gpu::engineFiles()) {
        if (row.target != target) continue;
        std::string text;
        try {
            text = textOf(row, brdf, options, exported);
        } catch (const UsageError& error) {
            listener.say(fmt::format("left out: {}", error.what()));
            continue;
        }
        const std::string file = exported.name + std::string(row.suffix);
        files.write(file, text);
        exported.texts.push_back({"module", std::string(target), file});
    }
}

}  // namespace hshfit::jobs
