#include "library_map.h"

#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>

namespace hshfit::embedded {
extern const std::string_view library_map_html, library_map_css, library_map_js;
}

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;
using kainjow::mustache::data;

/// "#aabbcc" of an albedo.
std::string colourText(const LinearRgb& rgb) {
    return fmt::format("#{:02x}{:02x}{:02x}", encoded(rgb[0]), encoded(rgb[1]), encoded(rgb[2]));
}

/// The data that the page draws: the answer with a picture and a colour for each row, and without
/// the table of all distances.
Json pageData(const LibraryMap& map) {
    Json document = libraryMapJson(map);
    document.erase("distances");
    document["library"] = map.library;
    for (std::size_t m = 0; m < map.materials.size(); ++m) {
        const material_library::MaterialLook& look = map.materials[m].look;
        document["materials"][m]["colour"] = colourText(look.albedo);
        document["materials"][m]["png"] = base64(spheresPng({&look.picture, 1}, map.stops));
    }
    return document;
}

}  // namespace

std::string libraryMapPage(const LibraryMap& map) {
    const std::string name = std::filesystem::path(map.library).stem().string();
    data page;
    page.set("title", name);
    page.set("generator", std::string("hshfit ") + version);
    page.set("count", std::to_string(map.materials.size()));
    page.set("pairs", std::to_string(map.duplicates.size()));
    page.set("near", fmt::format("{:g}", map.near));
    page.set("kept", fmt::format("{:.0f} %", 100 * map.kept));
    page.set("style", livePageStyle(embedded::library_map_css));
    page.set("data", scriptSafe(jsonText(pageData(map))));
    page.set("script", std::string(embedded::library_map_js));
    return filledPage(embedded::library_map_html, page);
}

}  // namespace hshfit::jobs
