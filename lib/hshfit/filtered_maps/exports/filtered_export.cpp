#include <hshfit/filtered_maps/exports/filtered_export.h>

#include <hshfit/files/json_fields.h>
#include <hshfit/filtered_maps/exports/filtered_shader.h>
#include <hshfit/filtered_maps/exports/internal/lobe_numbers.h>
#include <hshfit/gpu/containers/sidecar.h>
#include <hshfit/material_maps/exports/map_json.h>
#include <hshfit/material_maps/exports/map_viewer.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::inline filtered_maps::inline exports {
namespace {

using Json = nlohmann::ordered_json;

StoredLevels storedLevels(const LevelTexture& texture, std::span<const LevelSize> levels,
                          std::size_t layers, gpu::Number number) {
    return {.levels = levels, .layers = layers, .number = number, .bytes = [&](std::size_t level) {
                return texture.level(level);
            }};
}

Json numbersJson(const MipLayout& layout) {
    Json albedos = Json::array();
    for (int k = 0; k < layout.albedos; ++k) albedos.push_back(layout.albedo(k));
    return {{"normal", MipLayout::normal},
            {"plane", MipLayout::plane},
            {"plane_deviations", MipLayout::planeSquares},
            {"widths", MipLayout::widths},
            {"lobe", MipLayout::lobe},
            {"weights", MipLayout::weight},
            {"albedos", albedos}};
}

Json textureJson(const FilteredSidecar& s, std::size_t layers, std::span<const LevelSize> levels,
                 Wrap wrap) {
    return {{"number", gpu::numberName(s.number)},
            {"layers", layers},
            {"levels", levelsJson(levels)},
            {"layout", "layer n / 4, lane n % 4 has number n of a texel"},
            {"filter", "linear"},
            {"mip", "linear"},
            {"wrap", wrapName(wrap)},
            {"anisotropy", 1},
            {"srgb", false}};
}

Json mapJson(const FilteredSidecar& s, Wrap wrap) {
    Json json = textureJson(s, s.layers(), s.levels, wrap);
    json["numbers"] = numbersJson(s.layout);
    // Deviations and correlations are no means of texels.
    json["moments"] = {{"first", MipLayout::planeSquares}, {"last", MipLayout::lobe - 1}};
    return json;
}

Json harmonicsJson(const FilteredSidecar& s, Wrap wrap) {
    if (s.harmonics.empty()) return nullptr;
    Json json = textureJson(s, s.harmonicLayers(), s.harmonicLevels(), wrap);
    json["first_level"] = 1;
    json["order"] = s.layout.order;
    json["numbers"] = "weight k: slot l (l + 1) / 2 + m of even l, after k order (order + 1) / 2";
    return json;
}

Json sharedJson(const LobeNumbers& lobes) {
    return {{"number", gpu::numberName(lobes.texels.number)},
            {"width", lobes.texels.width},
            {"height", lobes.texels.height},
            {"layout", "quadruple n is texel (n % width, n / width)"},
            {"rows", lobes.rows},
            {"columns", lobes.columns},
            {"gaussians", lobes.gaussians}};
}

Json parametersJson(const FilteredSidecar& s) {
    Json rows = Json::array();
    for (const LobeNodes& nodes : s.nodes)
        rows.push_back({{"name", nodes.name}, {"nodes", nodes.values}});
    return rows;
}

Json termsJson(const FilteredSidecar& s) {
    Json rows = Json::array();
    for (const auto& term : s.terms) {
        Json weights = Json::array(), scales = Json::array();
        for (const LobeWeight& weight : term) {
            weights.push_back(weight.weight);
            scales.push_back(weight.scale);
        }
        rows.push_back({{"weights", weights}, {"scales", scales}});
    }
    return rows;
}

}  // namespace

std::vector<MapTextureFile> writeFilteredKtx2(const FilteredMap& map, const std::string& name,
                                              FileSet& files) {
    std::vector<MapTextureFile> made{
        writeTextureKtx2("map", name + ".map.ktx2", map.texture().file(), files)};
    if (map.harmonics() != nullptr) {
        made.push_back(writeTextureKtx2("harmonics", name + ".harmonics.ktx2",
                                        map.harmonics()->file(), files));
    }
    map.checkIntact();
    made.push_back(
        writeSharedKtx2(name + ".shared.ktx2", lobeNumbers(map.sidecar()).texels, files));
    return made;
}

std::vector<MapTextureFile> writeFilteredExr(const FilteredMap& map, const std::string& name,
                                             FileSet& files) {
    const FilteredSidecar& s = map.sidecar();
    std::vector<MapTextureFile> made{
        writeTextureExr("map", name + ".map.exr",
                        storedLevels(map.texture(), s.levels, s.layers(), s.number), files)};
    if (map.harmonics() != nullptr) {
        made.push_back(writeTextureExr(
            "harmonics", name + ".harmonics.exr",
            storedLevels(*map.harmonics(), s.harmonicLevels(), s.harmonicLayers(), s.number),
            files));
    }
    map.checkIntact();
    made.push_back(writeSharedExr(name + ".shared.exr", lobeNumbers(s).texels, files));
    return made;
}

std::string filteredExportText(const FilteredMap& map, Wrap wrap,
                               std::span<const MapTextureFile> textures,
                               std::span<const MapTest> tests) {
    const FilteredSidecar& s = map.sidecar();
    // All that a map's own file states, so that the export is read as that file is.
    const Json own = Json::parse(toText(s));
    Json document = {{"format", "hshfit-gpu-filtered-map"},
                     {"version", 1},
                     {"generator", std::string("hshfit ") + version},
                     {"source", s.source},
                     {"form", s.form},
                     {"model", s.model},
                     {"parameters", parametersJson(s)},
                     {"terms", termsJson(s)},
                     {"quantity", quantityName(Quantity::brdfCosine)},
                     {"channels", s.channels.names()},
                     {"frame", Json::parse(gpu::frameText())},
                     {"uv", "u to the right, v downwards from row 0, 0 to 1 from edge to edge"},
                     {"map", mapJson(s, wrap)},
                     {"harmonics", harmonicsJson(s, wrap)},
                     {"shared", sharedJson(lobeNumbers(s))},
                     {"files", filesJson(textures)},
                     {"tests", testsJson(tests)}};
    for (const char* key : {"order", "weights", "albedos", "lobes"}) document[key] = own[key];
    return gpu::readableSidecar(jsonText(document));
}

std::string filteredViewerPage(const FilteredMap& map, const LobeText& lobe, Wrap wrap,
                               const std::string& title, std::span<const MapTest> tests) {
    const FilteredSidecar& s = map.sidecar();
    const LevelSize& size = s.levels.front();
    const LobeNumbers lobes = lobeNumbers(s);
    const std::string order =
        s.form == "harmonics" ? fmt::format(" of order {}", s.layout.order) : "";
    MapPage page;
    page.form = s.form;
    page.title = title;
    page.summary = fmt::format("{} x {} texels of {} in {} levels; form {}{}, {} layers of {}",
                               size.width, size.height, s.model, s.levels.size(), s.form, order,
                               s.layers() + s.harmonicLayers(), gpu::numberName(s.number));
    page.map = storedLevels(map.texture(), s.levels, s.layers(), s.number);
    page.shared = &lobes.texels;
    page.channels = s.channels;
    page.cosine = true;
    page.wrap = wrap;
    page.tests = tests;
    page.snippet = filteredShader(gpu::Language::glslEs, s, lobe, {.wrap = wrap});
    page.raw = "hsh_eval";
    if (map.harmonics() != nullptr) {
        page.harmonics =
            storedLevels(*map.harmonics(), s.harmonicLevels(), s.harmonicLayers(), s.number);
    }
    return mapPage(page, "Fewer texels, and the form ellipse, are");
}

}  // namespace hshfit::inline filtered_maps::inline exports
