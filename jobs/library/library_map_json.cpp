#include "library_map.h"

#include "material_json.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;

/// To six decimals: 1,000 materials have half a million distances.
double rounded(double value) {
    return std::round(1e6 * value) / 1e6;
}

Json neighboursJson(const LibraryMap& map, const MappedMaterial& one) {
    Json list = Json::array();
    for (const Neighbour& other : one.neighbours)
        list.push_back({{"name", map.materials[other.material].material.name},
                        {"distance", rounded(other.distance)},
                        {"flip", rounded(other.flip)}});
    return list;
}

}  // namespace

Json libraryMapJson(const LibraryMap& map) {
    const std::size_t count = map.materials.size();
    Json materials = Json::array(), distances = Json::array(), duplicates = Json::array();
    for (std::size_t m = 0; m < count; ++m) {
        const MappedMaterial& one = map.materials[m];
        Json row = materialJson(one.material);
        row["place"] = {{"x", rounded(one.x)}, {"y", rounded(one.y)}};
        row["albedo"] = one.look.luminance;
        row["gloss"] = one.look.gloss;
        row["chroma"] = one.look.chroma;
        row["hue"] = one.look.hue;
        row["nearest"] = neighboursJson(map, one);
        materials.push_back(std::move(row));
        Json before = Json::array();
        for (std::size_t k = 0; k < m; ++k) before.push_back(rounded(map.distances[m * count + k]));
        distances.push_back(std::move(before));
    }
    for (const NearDuplicates& pair : map.duplicates)
        duplicates.push_back({{"first", map.materials[pair.first].material.name},
                              {"second", map.materials[pair.second].material.name},
                              {"distance", rounded(pair.distance)},
                              {"flip", rounded(pair.flip)}});
    return {{"near", map.near},
            {"kept", map.kept},
            {"width", rounded(map.width)},
            {"height", rounded(map.height)},
            {"stops", map.stops},
            {"materials", std::move(materials)},
            {"distances", std::move(distances)},
            {"duplicates", std::move(duplicates)}};
}

}  // namespace hshfit::jobs
