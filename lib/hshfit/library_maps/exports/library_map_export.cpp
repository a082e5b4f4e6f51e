#include <hshfit/library_maps/exports/library_map_export.h>

#include <hshfit/files/checksum.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/gpu/containers/ktx2_image.h>
#include <hshfit/gpu/containers/sidecar.h>
#include <hshfit/material_maps/exports/map_json.h>
#include <hshfit/material_maps/exports/map_viewer.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace hshfit::inline library_maps::inline exports {
namespace {

using Json = nlohmann::ordered_json;

std::string libraryName(const std::string& name) {
    return name + ".library";
}

LevelSize sizeOf(const gpu::Texels& texels) {
    return {static_cast<std::size_t>(texels.width), static_cast<std::size_t>(texels.height)};
}

/// The name of an export, whose library stands beside its textures.
std::string libraryOf(std::span<const MapTextureFile> textures) {
    for (const MapTextureFile& file : textures)
        if (file.role == "library") return file.path;
    return {};
}

Json functionsJson(const MapFunctions& functions) {
    const gpu::FunctionTable& table = *functions.sums.table;
    return {{"half", table.size().half},
            {"plane", table.size().plane},
            {"horizon", table.size().horizon},
            {"number", gpu::numberName(table.texels().number)},
            {"layers", table.groups()},
            {"filter", "linear"},
            {"wrap", "clamp"},
            {"mip", "none"},
            {"error", {{"largest", functions.error.largest}, {"mean", functions.error.mean}}}};
}

}  // namespace

std::vector<MapTextureFile> writeLibraryMapKtx2(const LibraryMap& map,
                                                const MapFunctions& functions,
                                                const std::string& name, FileSet& files) {
    std::vector<MapTextureFile> made{
        writeTextureKtx2("map", name + ".map.ktx2", map.texture().file(), files)};
    map.checkIntact();
    const gpu::Texels& table = functions.sums.table->texels();
    const std::vector<std::byte> levels[] = {table.bytes};
    const LevelSize size = sizeOf(table);
    const std::string file = gpu::ktx2File({.number = table.number,
                                            .width = size.width,
                                            .height = size.height,
                                            .layers = table.layers},
                                           levels);
    made.push_back(writeTextureKtx2("functions", name + ".functions.ktx2",
                                    std::as_bytes(std::span(file)), files));
    return made;
}

std::vector<MapTextureFile> writeLibraryMapExr(const LibraryMap& map, const MapFunctions& functions,
                                               const std::string& name, FileSet& files) {
    const LibrarySidecar& s = map.sidecar();
    const gpu::Texels& table = functions.sums.table->texels();
    const LevelSize size[] = {sizeOf(table)};
    std::vector<MapTextureFile> made{
        writeTextureExr("map", name + ".map.exr",
                        {.levels = s.levels,
                         .layers = s.layout.layers(),
                         .number = s.number,
                         .bytes = [&](std::size_t level) { return map.texture().level(level); }},
                        files)};
    map.checkIntact();
    made.push_back(writeTextureExr("functions", name + ".functions.exr",
                                   {.levels = size,
                                    .layers = table.layers,
                                    .number = table.number,
                                    .bytes = [&](std::size_t) { return std::span(table.bytes); }},
                                   files));
    return made;
}

MapTextureFile writeMapLibrary(const LibraryMap& map, const std::string& name, FileSet& files) {
    const MappedFile library(map.sidecar().library);
    MapTextureFile copied =
        writeTextureKtx2("library", libraryName(name), std::as_bytes(library.bytes()), files);
    library.checkIntact();
    copied.container = "library";
    return copied;
}

std::string libraryMapExportText(const LibraryMap& map, const MapFunctions& functions, Wrap wrap,
                                 std::span<const MapTextureFile> textures,
                                 std::span<const MapTest> tests) {
    const LibrarySidecar& s = map.sidecar();
    const Json document = {
        {"format", libraryMapExportFormat},
        {"version", 1},
        {"generator", std::string("hshfit ") + version},
        {"source", s.source},
        {"form", "library"},
        {"channels", s.channels.names()},
        {"library",
         {{"file", libraryOf(textures)}, {"sha256", s.sum}, {"components", s.layout.components}}},
        {"frame", Json::parse(gpu::frameText())},
        {"uv", "u to the right, v downwards from row 0, 0 to 1 from edge to edge"},
        {"value", "f = max(exp(min(Phi_0 + sum_k q_k Phi_k, first + step t)) - offset, 0)"},
        {"bound", {{"first", functions.sums.topFirst}, {"step", functions.sums.topStep}}},
        {"offset", functions.sums.offset},
        {"map",
         {{"number", gpu::numberName(s.number)},
          {"layers", s.layout.layers()},
          {"levels", levelsJson(s.levels)},
          {"layout",
           "layer 0: t of each channel, lane 3 the error; layer 1 + channels g + c: of channel c "
           "the factors of functions 4 g to 4 g + 3, q_0 = 1"},
          {"filter", "linear"},
          {"mip", "linear"},
          {"wrap", wrapName(wrap)},
          {"anisotropy", 1},
          {"srgb", false}}},
        {"functions", functionsJson(functions)},
        {"files", filesJson(textures)},
        {"tests", testsJson(tests)}};
    return gpu::readableSidecar(jsonText(document));
}

std::string libraryMapViewerPage(const LibraryMap& map, const MapFunctions& functions, Wrap wrap,
                                 const std::string& title, std::span<const MapTest> tests) {
    const LibrarySidecar& s = map.sidecar();
    const gpu::Texels& table = functions.sums.table->texels();
    const LevelSize& size = s.levels.front();
    const LevelSize tableSize[] = {sizeOf(table)};
    MapPage page;
    page.form = "library";
    page.title = title;
    page.summary =
        fmt::format("{} x {} materials in {} levels; form library, {} components, {} layers of {}",
                    size.width, size.height, s.levels.size(), s.layout.components,
                    s.layout.layers(), gpu::numberName(s.number));
    page.map.levels = s.levels;
    page.map.layers = s.layout.layers();
    page.map.number = s.number;
    page.map.bytes = [&](std::size_t level) { return map.texture().level(level); };
    page.harmonics.levels = tableSize;
    page.harmonics.layers = table.layers;
    page.harmonics.number = table.number;
    page.harmonics.bytes = [&](std::size_t) { return std::span<const std::byte>(table.bytes); };
    page.channels = s.channels;
    page.wrap = wrap;
    page.tests = tests;
    page.snippet = libraryMapShader(gpu::Language::glslEs, map, functions, {.wrap = wrap});
    page.raw = "hsh_eval";
    return mapPage(page, "Fewer texels and fewer components are");
}

}  // namespace hshfit::inline library_maps::inline exports
