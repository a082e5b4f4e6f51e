#include <hshfit/material_maps/exports/map_viewer.h>

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>
#include <hshfit/material_maps/exports/shared_numbers.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::embedded {
extern const std::string_view map_page, map_page_style, map_page_main, map_page_renderer,
    map_page_vert, map_page_frag, map_page_check;
}  // namespace hshfit::embedded

namespace hshfit::inline material_maps::inline exports {
namespace {

using Json = nlohmann::ordered_json;
using kainjow::mustache::data;

Json pageLevelsJson(const MaterialMap& map) {
    Json levels = Json::array();
    for (std::size_t k = 0; k < map.sidecar().levels.size(); ++k) {
        levels.push_back({{"width", map.sidecar().levels[k].width},
                          {"height", map.sidecar().levels[k].height},
                          {"bytes", base64(map.level(k))}});
    }
    return levels;
}

Json pageSharedJson(const MapSidecar& map) {
    if (map.form == "outgoing") return nullptr;
    const gpu::Texels texels = sharedNumbers(map).texels;
    return {{"width", texels.width}, {"height", texels.height}, {"bytes", base64(texels.bytes)}};
}

/// [slot][R, G, B].
Json pageLightsJson(const std::vector<gpu::ViewerLight>& lights) {
    Json rows = Json::array();
    for (const gpu::ViewerLight& light : lights) {
        const LightCoefficients& c = light.coefficients;
        Json values = Json::array();
        for (std::size_t i = 0; i < c.slots(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                values.push_back(c.at(c.channels.count() == 1 ? 0 : k)[i]);
        rows.push_back({{"name", light.name}, {"coefficients", values}});
    }
    return rows;
}

Json pageTestsJson(std::span<const MapTest> tests) {
    Json rows = Json::array();
    for (const MapTest& t : tests) {
        rows.push_back({{"numbers",
                         {t.place.u, t.place.v, t.place.level, 0, t.wo.x, t.wo.y, t.wo.z, 0, t.wi.x,
                          t.wi.y, t.wi.z, 0}},
                        {"value", t.value}});
    }
    return rows;
}

void checkViewer(const MapViewerInput& input) {
    std::size_t bytes = 0;
    for (std::size_t k = 0; k < input.map.sidecar().levels.size(); ++k)
        bytes += input.map.level(k).size();
    if (bytes > mostViewerBytes) {
        throw UsageError(fmt::format(
            "the texels are {} MB; a viewer holds at most {} MB. The forms low-rank and clusters "
            "are smaller",
            bytes / 1000000, mostViewerBytes / 1000000));
    }
    if (input.lights.empty()) throw UsageError("a viewer needs a light");
    for (const gpu::ViewerLight& light : input.lights) {
        if (light.coefficients.order == input.order) continue;
        throw UsageError(fmt::format("{}: a light of {} bands in a viewer of {}", light.name,
                                     light.coefficients.order, input.order));
    }
}

std::string summaryOf(const MapSidecar& map) {
    const LevelSize& size = map.levels.front();
    return fmt::format("{} x {} materials in {} levels; form {}{}, {} order {}, {} layers of {}",
                       size.width, size.height, map.levels.size(), map.form,
                       map.form == "outgoing" ? "" : fmt::format(" of rank {}", map.rank()),
                       map.basis, map.order, map.layers(), gpu::numberName(map.number));
}

}  // namespace

std::string mapViewerPage(const MapViewerInput& input) {
    checkViewer(input);
    const MapSidecar& map = input.map.sidecar();
    const std::string snippet = mapShader(gpu::Language::glslEs, map,
                                          {.environmentOrder = input.order, .wrap = input.wrap});
    const Json document = {{"form", map.form},
                           {"channels", map.channels.count()},
                           {"number", gpu::numberName(map.number)},
                           {"layers", map.layers()},
                           {"levels", pageLevelsJson(input.map)},
                           {"shared", pageSharedJson(map)},
                           {"wrap", wrapName(input.wrap)},
                           {"cosine", map.quantity == Quantity::brdfCosine},
                           {"order", input.order},
                           {"lights", pageLightsJson(input.lights)},
                           {"tests", pageTestsJson(input.tests)},
                           {"shaders",
                            {{"snippet", snippet},
                             {"vertex", embedded::map_page_vert},
                             {"fragment", embedded::map_page_frag},
                             {"check", embedded::map_page_check}}}};
    data page;
    page.set("title", input.title);
    page.set("summary", summaryOf(map));
    page.set("generator", std::string("hshfit ") + version);
    page.set("style", livePageStyle(embedded::map_page_style));
    page.set("lastLevel", std::to_string(map.levels.size() - 1));
    page.set("repeat", input.wrap == Wrap::repeat);
    page.set("data", scriptSafe(jsonText(document)));
    page.set("script", std::string(gpu::harmonicsScript()) +
                           std::string(embedded::map_page_renderer) +
                           std::string(embedded::map_page_main));
    return printableLines(
        kainjow::mustache::mustache(std::string(embedded::map_page)).render(page));
}

}  // namespace hshfit::inline material_maps::inline exports
