#include <hshfit/material_maps/exports/map_viewer.h>

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/template_text.h>
#include <hshfit/material_maps/exports/shared_numbers.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <optional>

namespace hshfit::embedded {
extern const std::string_view map_page, map_page_style, map_page_main, map_page_renderer,
    map_page_vert, map_page_frag, map_page_check;
}  // namespace hshfit::embedded

namespace hshfit::inline material_maps::inline exports {
namespace {

using Json = nlohmann::ordered_json;
using kainjow::mustache::data;

Json pageLevelsJson(const StoredLevels& stored) {
    Json levels = Json::array();
    for (std::size_t k = 0; k < stored.levels.size(); ++k) {
        levels.push_back({{"width", stored.levels[k].width},
                          {"height", stored.levels[k].height},
                          {"bytes", base64(stored.bytes(k))}});
    }
    return levels;
}

Json pageHarmonicsJson(const StoredLevels& stored) {
    if (stored.levels.empty()) return nullptr;
    return {{"layers", stored.layers}, {"levels", pageLevelsJson(stored)}};
}

Json pageSharedJson(const gpu::Texels* texels) {
    if (texels == nullptr) return nullptr;
    return {{"width", texels->width}, {"height", texels->height}, {"bytes", base64(texels->bytes)}};
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

void checkPage(const MapPage& page, std::string_view smaller) {
    std::size_t bytes = 0;
    for (const StoredLevels* stored : {&page.map, &page.harmonics})
        for (std::size_t k = 0; k < stored->levels.size(); ++k) bytes += stored->bytes(k).size();
    if (bytes > mostViewerBytes) {
        throw UsageError(
            fmt::format("the texels are {} MB; a viewer holds at most {} MB. {} smaller",
                        bytes / 1000000, mostViewerBytes / 1000000, smaller));
    }
    for (const gpu::ViewerLight& light : page.lights) {
        if (light.coefficients.order == page.order) continue;
        throw UsageError(fmt::format("{}: a light of {} bands in a viewer of {}", light.name,
                                     light.coefficients.order, page.order));
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

std::string mapPage(const MapPage& input, std::string_view smaller) {
    checkPage(input, smaller);
    const std::string check =
        fmt::format("#define VALUE {}\n{}", input.raw, embedded::map_page_check);
    const Json document = {{"form", input.form},
                           {"channels", input.channels.count()},
                           {"number", gpu::numberName(input.map.number)},
                           {"layers", input.map.layers},
                           {"levels", pageLevelsJson(input.map)},
                           {"harmonics", pageHarmonicsJson(input.harmonics)},
                           {"shared", pageSharedJson(input.shared)},
                           {"wrap", wrapName(input.wrap)},
                           {"cosine", input.cosine},
                           {"order", input.order},
                           {"lights", pageLightsJson(input.lights)},
                           {"tests", pageTestsJson(input.tests)},
                           {"shaders",
                            {{"snippet", input.snippet},
                             {"vertex", embedded::map_page_vert},
                             {"fragment", embedded::map_page_frag},
                             {"check", check}}}};
    data page;
    page.set("title", input.title);
    page.set("summary", input.summary);
    page.set("generator", std::string("hshfit ") + version);
    page.set("style", livePageStyle(embedded::map_page_style));
    page.set("lastLevel", std::to_string(input.map.levels.size() - 1));
    page.set("repeat", input.wrap == Wrap::repeat);
    page.set("lit", !input.lights.empty());
    page.set("data", scriptSafe(jsonText(document)));
    page.set("script", std::string(gpu::harmonicsScript()) +
                           std::string(embedded::map_page_renderer) +
                           std::string(embedded::map_page_main));
    return filledPage(embedded::map_page, page);
}

std::string mapViewerPage(const MapViewerInput& input) {
    if (input.lights.empty()) throw UsageError("a viewer needs a light");
    const MapSidecar& map = input.map.sidecar();
    std::optional<SharedNumbers> shared;
    if (map.form != "outgoing") shared = sharedNumbers(map);
    MapPage page;
    page.form = map.form;
    page.title = input.title;
    page.summary = summaryOf(map);
    page.map.levels = map.levels;
    page.map.layers = map.layers();
    page.map.number = map.number;
    page.map.bytes = [&](std::size_t level) { return input.map.level(level); };
    page.shared = shared ? &shared->texels : nullptr;
    page.channels = map.channels;
    page.cosine = map.quantity == Quantity::brdfCosine;
    page.wrap = input.wrap;
    page.lights = input.lights;
    page.order = input.order;
    page.tests = input.tests;
    page.snippet = mapShader(gpu::Language::glslEs, map,
                             {.environmentOrder = input.order, .wrap = input.wrap});
    return mapPage(page, "The forms low-rank and clusters are");
}

}  // namespace hshfit::inline material_maps::inline exports
