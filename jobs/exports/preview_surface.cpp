#include "preview_surface.h"

#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <brdfs/analytic/gltf_pbr.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace hshfit::jobs {
namespace {

constexpr std::array<std::string_view, 6> previewInputs{
    "baseColorFactor", "metallicFactor",          "roughnessFactor", "ior",
    "clearcoatFactor", "clearcoatRoughnessFactor"};

/// The stated parameters of a model, and the part that may be fitted with them.
struct PreviewRow {
    std::string_view stated, part;
};
constexpr PreviewRow previewRows[] = {
    {"metallicFactor=0,clearcoatFactor=0,clearcoatRoughnessFactor=0", "ior"},
    {"metallicFactor=0,ior=1.5", "clearcoat"},
    {"metallicFactor=1,ior=1.5", "clearcoat"}};

}  // namespace

std::vector<std::string> outsidePreview(const Parameters& gltf) {
    std::vector<std::string> names;
    for (const Parameter& parameter : brdfs::gltfPbrModel().parameters) {
        const std::vector<double> values = gltf.colour(parameter.name);
        const bool plain =
            std::ranges::all_of(values, [&](double value) { return value == *parameter.fallback; });
        if (std::ranges::find(previewInputs, parameter.name) == previewInputs.end() && !plain)
            names.emplace_back(parameter.name);
    }
    const double metallic = gltf.number("metallicFactor");
    if (metallic != 0 && metallic != 1) names.emplace_back("metallicFactor between 0 and 1");
    if (gltf.number("clearcoatFactor") > 0 && gltf.number("ior") != 1.5)
        names.emplace_back("ior below a clearcoat");
    return names;
}

std::vector<PreviewModel> previewModels(const std::string& parts) {
    if (parts != "auto" && parts != "none" && parts != "all")
        throw UsageError(fmt::format("{} '{}': for the target usd, expected auto, none or all",
                                     Setting{"FitOptions::parts"}, parts));
    std::string others;
    for (const Parameter& parameter : brdfs::gltfPbrModel().parameters)
        if (std::ranges::find(previewInputs, parameter.name) == previewInputs.end())
            others += fmt::format(",{}={}", parameter.name, *parameter.fallback);
    std::vector<PreviewModel> models;
    for (const PreviewRow& row : previewRows) {
        models.push_back({fmt::format("gltf-pbr:{}{}", row.stated, others),
                          parts == "all" ? std::string(row.part) : parts});
    }
    return models;
}

UsdPreviewSurface previewOf(const Parameters& gltf) {
    const std::vector<double> base = gltf.colour("baseColorFactor");
    UsdPreviewSurface material;
    for (std::size_t c = 0; c < 3; ++c) material.diffuseColour[c] = base[base.size() == 3 ? c : 0];
    material.metallic = gltf.number("metallicFactor");
    material.roughness = gltf.number("roughnessFactor");
    material.ior = gltf.number("ior");
    material.clearcoat = gltf.number("clearcoatFactor");
    material.clearcoatRoughness = gltf.number("clearcoatRoughnessFactor");
    return material;
}

}  // namespace hshfit::jobs
