#include <hshfit/material_maps/exports/map_export.h>

#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/containers/ktx2_image.h>
#include <hshfit/gpu/containers/sidecar.h>
#include <hshfit/material_maps/exports/map_json.h>
#include <hshfit/version.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::inline material_maps::inline exports {
namespace {

using Json = nlohmann::ordered_json;

Json mapJson(const MapSidecar& map, Wrap wrap) {
    const bool clusters = map.form == "clusters";
    const char* layout =
        map.form == "outgoing"
            ? "layer o * groups + g, lane 4 g + k = channel * slots + slot of outgoing direction o"
        : clusters ? "index = round(255 r) + 256 round(255 g), error = (b, a) likewise / 65535"
                   : "layer g, lane 4 g + k = channel * rank + r";
    return {{"number", gpu::numberName(map.number)},
            {"layers", map.layers()},
            {"levels", levelsJson(map.levels)},
            {"layout", layout},
            {"groups", map.form == "outgoing" ? map.layout.groups() : map.layers()},
            {"filter", clusters ? "none" : "linear"},
            {"mip", clusters ? "none" : "linear"},
            {"wrap", wrapName(wrap)},
            {"anisotropy", 1},
            {"srgb", false}};
}

Json sharedJson(const MapSidecar& map) {
    if (map.form == "outgoing") return nullptr;
    const SharedNumbers shared = sharedNumbers(map);
    return {{"number", gpu::numberName(shared.texels.number)},
            {"width", shared.texels.width},
            {"height", shared.texels.height},
            {"layout", "quadruple n is texel (n % width, n / width)"},
            {"rank", map.rank()},
            {"shape_groups", shared.groupsOfShapes},
            {"first_material", shared.firstMaterial},
            {"material_groups", shared.groupsOfMaterial},
            {"materials", map.centres.size() / (map.channels.count() * map.rank())}};
}

Json vectorJson(const Direction& d) {
    return {d.x, d.y, d.z};
}

}  // namespace

Json filesJson(std::span<const MapTextureFile> files) {
    Json rows = Json::array();
    for (const MapTextureFile& file : files) {
        rows.push_back({{"role", file.role},
                        {"container", file.container},
                        {"path", file.path},
                        {"bytes", file.bytes},
                        {"sha256", file.sha256}});
    }
    return rows;
}

Json testsJson(std::span<const MapTest> tests) {
    Json rows = Json::array();
    for (const MapTest& test : tests) {
        rows.push_back({{"uv", {test.place.u, test.place.v}},
                        {"lod", test.place.level},
                        {"wo", vectorJson(test.wo)},
                        {"wi", vectorJson(test.wi)},
                        {"value", test.value}});
    }
    return rows;
}

MapTextureFile writeTextureKtx2(std::string_view role, const std::string& name,
                                std::span<const std::byte> bytes, FileSet& files) {
    constexpr std::size_t piece = std::size_t{64} << 20;
    files.write(name, [&](AtomicFile& file) {
        for (std::size_t at = 0; at < bytes.size(); at += piece)
            file.write(bytes.subspan(at, std::min(piece, bytes.size() - at)));
    });
    return {std::string(role), "ktx2", name, bytes.size(), sha256(bytes)};
}

MapTextureFile writeSharedKtx2(const std::string& name, const gpu::Texels& texels, FileSet& files) {
    const std::vector<std::byte> levels[] = {texels.bytes};
    const std::string file = gpu::ktx2File({.number = texels.number,
                                            .width = static_cast<std::size_t>(texels.width),
                                            .height = static_cast<std::size_t>(texels.height),
                                            .layers = 1},
                                           levels);
    return writeTextureKtx2("shared", name, std::as_bytes(std::span(file)), files);
}

std::vector<MapTextureFile> writeMapKtx2(const MaterialMap& map, const std::string& name,
                                         FileSet& files) {
    std::vector<MapTextureFile> made{
        writeTextureKtx2("map", name + ".map.ktx2", map.file(), files)};
    map.checkIntact();
    if (map.sidecar().form != "outgoing") {
        made.push_back(
            writeSharedKtx2(name + ".shared.ktx2", sharedNumbers(map.sidecar()).texels, files));
    }
    return made;
}

std::string mapExportText(const MaterialMap& map, Wrap wrap,
                          std::span<const MapTextureFile> textures,
                          std::span<const MapTest> tests) {
    const MapSidecar& s = map.sidecar();
    // All that a map's own file states, so that the export is read as that file is.
    const Json own = Json::parse(toText(s));
    Json document = {
        {"format", "hshfit-gpu-map"},
        {"version", 1},
        {"generator", std::string("hshfit ") + version},
        {"source", s.source},
        {"form", s.form},
        {"basis", {{"name", s.basis}, {"order", s.order}, {"index", "l*(l+1)+m"}}},
        {"quantity", quantityName(s.quantity)},
        {"channels", s.channels.names()},
        {"outgoing", s.layout.outgoing.spec()},
        {"slots", s.layout.slots},
        {"frame", Json::parse(gpu::frameText())},
        {"uv", "u to the right, v downwards from row 0, 0 to 1 from edge to edge"},
        {"sum", s.form == "outgoing" ? "q_c = sum_j C_cj(uv, lod, wo) B_slots[j](wi)"
                                     : "q_c = sum_r y_cr(uv, lod) sum_j S_rj(wo) B_slots[j](wi)"},
        {"map", mapJson(s, wrap)},
        {"shared", sharedJson(s)},
        {"files", filesJson(textures)},
        {"tests", testsJson(tests)}};
    for (const char* key : {"symmetry", "shapes", "materials"})
        if (own.contains(key)) document[key] = own[key];
    return gpu::readableSidecar(jsonText(document));
}

std::string mapTestText(const Channels& channels, std::string_view value,
                        std::span<const MapTest> tests) {
    return gpu::readableSidecar(jsonText(Json{{"format", "hshfit-gpu-map-test"},
                                              {"version", 1},
                                              {"channels", channels.names()},
                                              {"value", value},
                                              {"tests", testsJson(tests)}}));
}

std::string mapTestText(const MapSidecar& map, std::span<const MapTest> tests) {
    return mapTestText(map.channels,
                       map.quantity == Quantity::brdf ? "f in 1/sr, not clamped"
                                                      : "f cos(theta_i) in 1/sr, not clamped",
                       tests);
}

}  // namespace hshfit::inline material_maps::inline exports
