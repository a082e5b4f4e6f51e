#include "export_map.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::cli {

using Json = nlohmann::ordered_json;

Json mapDocument(const jobs::ExportedMap& exported, const std::string& folder) {
    const jobs::ExportableMap::Facts& map = exported.map;
    Json files = Json::array({{{"role", "sidecar"}, {"path", exported.sidecar}},
                              {{"role", "test"}, {"path", exported.test}}});
    for (const MapTextureFile& file : exported.textures) {
        files.push_back({{"role", file.role},
                         {"target", file.container},
                         {"path", file.path},
                         {"bytes", file.bytes},
                         {"sha256", file.sha256}});
    }
    for (const jobs::ExportedMapText& file : exported.texts)
        files.push_back({{"role", file.role}, {"target", file.target}, {"path", file.path}});
    Json document = {{"format", "hshfit-export-map"},
                     {"version", 1},
                     {"folder", folder},
                     {"name", exported.name},
                     {"source", map.source},
                     {"form", map.form},
                     {"width", map.levels.front().width},
                     {"height", map.levels.front().height},
                     {"levels", map.levels.size()},
                     {"layers", map.layers},
                     {"number", gpu::numberName(map.number)}};
    if (!map.basis.empty()) document["basis"] = map.basis;
    if (!map.model.empty()) document["model"] = map.model;
    if (map.order > 0) document["order"] = map.order;
    if (map.components > 0) {
        document["components"] = map.components;
        document["table_error"] = map.tableError;
    }
    if (!map.outgoing.empty()) document["outgoing"] = map.outgoing;
    document["files"] = files;
    for (const gpu::ViewerLight& light : exported.lights) {
        document["lights"].push_back(
            {{"light", light.name},
             {"bands", light.coefficients.order},
             {"captured", std::isfinite(light.captured) ? Json(light.captured) : Json()}});
    }
    return document;
}

bool isMapDocument(const Json& document) {
    return document["format"] == "hshfit-export-map";
}

std::string mapDocumentText(const Json& document) {
    const auto words = [&](const char* key) { return document[key].get<std::string>(); };
    const std::string order =
        document.contains("order") ? fmt::format(" order {}", document["order"].get<int>()) : "";
    // The order of the basis, or of the harmonics that the form is named after.
    const std::string form = document.contains("basis")
                                 ? fmt::format("{}, {}{}", words("form"), words("basis"), order)
                                 : fmt::format("{}{}", words("form"), order);
    std::string out =
        fmt::format("{}: map of {} x {} materials in {} levels, form {}, {} layers of {}\n",
                    words("folder"), document["width"].get<std::size_t>(),
                    document["height"].get<std::size_t>(), document["levels"].get<std::size_t>(),
                    form, document["layers"].get<std::size_t>(), words("number"));
    for (const Json& file : document["files"])
        out += fmt::format("  {}\n", file["path"].get<std::string>());
    return out;
}

}  // namespace hshfit::cli
