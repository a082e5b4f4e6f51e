#include <hshfit/filtered_maps/exports/filtered_shader.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/filtered_maps/exports/internal/lobe_numbers.h>
#include <hshfit/filtered_maps/exports/internal/shader_functions.h>
#include <hshfit/gpu/language_words.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/material_maps/exports/map_text.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace hshfit::embedded {
extern const std::string_view filtered_facets, filtered_functions, filtered_harmonics,
    filtered_header, filtered_texel, filtered_value;
}  // namespace hshfit::embedded

namespace hshfit::inline filtered_maps::inline exports {
namespace {

using gpu::Language;
using gpu::shaderNumber;
using kainjow::mustache::data;

/// The layers before the ones that the sampler may blend.
constexpr std::size_t momentLayers = 3;

/// The name that a snippet gives to a number of a texel.
std::string nameOf(std::size_t number) {
    return fmt::format("x{}.{}", number / 4, gpu::laneNames[number % 4]);
}

std::size_t weightNumber(std::size_t k) {
    return MipLayout::weight + k;
}

/// Rows of the layers that numbers are in.
data layersOf(const std::vector<std::size_t>& numbers) {
    std::set<std::size_t> layers;
    for (const std::size_t number : numbers) layers.insert(number / 4);
    data rows = gpu::list();
    for (const std::size_t layer : layers) rows.push_back(data("layer", std::to_string(layer)));
    return rows;
}

void setFunctions(Language language, data& page) {
    ShaderFunctions f(language, page);
    f.addStruct("texelStruct", "Texel",
                {{"vec3", "mean"},
                 {"real", "mx"},
                 {"real", "my"},
                 {"real", "cxx"},
                 {"real", "cxy"},
                 {"real", "cyy"},
                 {"real", "wxx"},
                 {"real", "wxy"},
                 {"real", "wyy"},
                 {"real", "row"},
                 {"real", "column"}});
    f.addStruct("facetsStruct", "Facets",
                {{"real", "density"},
                 {"real", "x"},
                 {"real", "y"},
                 {"real", "xx"},
                 {"real", "xy"},
                 {"real", "yy"}});
    const Named node{"vec4", "node"}, wi{"vec3", "wi"}, wo{"vec3", "wo"}, t{"Texel", "t"},
        n{"vec3", "n"}, x{"real", "x"}, y{"real", "y"}, uv{"vec2", "uv"}, lod{"real", "lod"},
        level{"real", "level"}, h{"vec3", "h"}, facets{"Facets", "f"};
    f.add("erfcHead", "real", "erfc", {x});
    f.add("axesHead", "vec2", "axes", {node});
    f.add("densityHead", "real", "density", {h, node});
    f.add("termsHead", "vec3", "terms", {wi, wo, node});
    f.add("smoothHead", "real", "smooth", {wi, wo, node});
    f.add("nodeHead", "vec4", "node", {{"real", "row"}, {"real", "column"}}, true);
    f.add("sideHead", "real", "side", {{"real", "whole"}, level});
    f.add("cornerHead", "vec4", "corner", {x, y, level, {"int", "layer"}}, true);
    f.add("texelHead", "Texel", "texel", {uv, lod}, true);
    f.add("normalHead", "vec3", "normal", {t});
    f.add("toPlaneHead", "vec2", "toPlane", {n});
    f.add("fromPlaneHead", "vec3", "fromPlane", {x, y});
    f.add("halfAngleHead", "vec2", "halfAngle", {x, y});
    f.add("tangentHead", "vec3", "tangent", {t, node, n});
    f.add("localHead", "vec3", "local", {n, {"vec3", "tangent"}, {"vec3", "d"}});
    f.add("facetsHead", "Facets", "facets", {t, h}, true);
    f.add("facetHead", "vec3", "facet", {t, node, x, y, wi, wo});
    f.add("meanTermsHead", "vec3", "meanTerms", {t, facets, node, wi, wo});
    f.add("laneHead", "real", "lane", {{"vec4", "four"}, {"int", "lane"}});
    f.add("sumHead", "real", "sum", {uv, lod, h, {"int", "first"}}, true);
    f.add("shareHead", "real", "share", {x});
    f.add("meanAboveHead", "real", "meanAbove", {{"real", "mean"}, {"real", "variance"}});
    std::vector<Named> nine;
    for (const char* name : {"c0", "c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8"})
        nine.push_back({"real", name});
    nine.insert(nine.end(), {wi, wo});
    f.add("bothAboveHead", "real", "bothAbove", nine);
    f.add("aboveHead", "vec3", "above", {{"vec3", "d"}});
    f.add("plainHead", "type", "plain", {uv, wo, wi}, true);
    f.add("filteredHead", "type", "filtered", {uv, lod, wo, wi}, true);
    f.add("evalHead", "type", "eval", {uv, lod, wo, wi}, true);
    f.add("levelHead", "real", "level", {{"vec2", "dx"}, {"vec2", "dy"}});
    const bool wgsl = language == Language::wgsl;
    const std::string prefix = gpu::wordOf(page, "prefix");
    page.set("letTexel", wgsl ? "let" : prefix + "_Texel");
    page.set("letFacets", wgsl ? "let" : prefix + "_Facets");
    page.set("letValue", wgsl ? "let" : gpu::wordOf(page, "type"));
}

/// The parts that a lobe's text has of its own.
void setLobe(const LobeText& lobe, data& page) {
    for (const auto& [word, text] : lobe.words) page.set(word, text);
    for (const char* flag :
         {"gaussian", "smith", "correlated", "schlick", "squared", "rootNorm", "reciprocalNorm"})
        page.set(flag, false);
    for (const std::string& flag : lobe.flags) page.set(flag, true);
    data rows = gpu::list();
    std::vector<std::string> reflectances;
    for (std::size_t i = 0; i < lobe.indices.size(); ++i) {
        data row;
        row.set("i", std::to_string(i));
        for (const auto& [word, text] : lobe.indices[i]) row.set(word, text);
        rows.push_back(row);
        reflectances.push_back(fmt::format("lobe * f{}", i));
    }
    reflectances.resize(3, "0.0");
    page.set("indices", rows);
    page.set("reflectances", fmt::format("{}", fmt::join(reflectances, ", ")));
    page.set("smooth", !lobe.smooth.empty());
    setPartials({{"lobeAxes", lobe.axes},
                 {"lobeDensity", lobe.density},
                 {"lobeTerms", lobe.terms},
                 {"lobeSmooth", lobe.smooth}},
                page);
}

/// Lookups of the nodes around a place, and their blend.
void setNodes(const FilteredSidecar& map, const LobeNumbers& lobes, data& page) {
    const auto last = [](std::size_t count) { return fmt::format("{}.0", count - 1); };
    const auto most = [](std::size_t count) {
        return fmt::format("{}.0", count > 1 ? count - 2 : 0);
    };
    page.set("gaussians", std::to_string(lobes.gaussians));
    page.set("oneNode", false);
    if (lobes.nodes() == 1) {
        const StoredLobe& lobe = map.lobes.front();
        const auto value = [&](std::size_t k) {
            return k < map.nodes.size() ? map.nodes[k].values.front() : 0.0;
        };
        page.set("oneNode",
                 fmt::format("{}, {}, {}, {}", shaderNumber(lobe.widthX), shaderNumber(lobe.widthY),
                             shaderNumber(value(0)), shaderNumber(value(1))));
        page.set("firstGaussian", "1");
        return;
    }
    page.set("lastRow", last(lobes.rows));
    page.set("lastColumn", last(lobes.columns));
    page.set("topMost", most(lobes.rows));
    page.set("leftMost", most(lobes.columns));
    page.set("columns", std::to_string(lobes.columns));
    data rows = gpu::list();
    std::vector<std::string> lanes(4);
    std::size_t k = 0;
    for (std::size_t below = 0; below < std::min<std::size_t>(lobes.rows, 2); ++below) {
        for (std::size_t beside = 0; beside < std::min<std::size_t>(lobes.columns, 2); ++beside) {
            data row;
            row.set("k", std::to_string(k));
            row.set("offset", std::to_string(below * lobes.columns + beside));
            row.set("share", fmt::format("{} * {}", below ? "partY" : "(1.0 - partY)",
                                         beside ? "partX" : "(1.0 - partX)"));
            rows.push_back(row);
            for (std::size_t lane = 0; lane < 4; ++lane)
                lanes[lane] +=
                    fmt::format("{}s{} * n{}.{}", k ? " + " : "", k, k, gpu::laneNames[lane]);
            ++k;
        }
    }
    page.set("nodes", rows);
    page.set("mixed", fmt::format("{}", fmt::join(lanes, ", ")));
    // The nearest node, as LobeTable::gaussians takes it: the lower of two nodes that are equally
    // near, with a margin for half precision.
    const std::string toInt = gpu::wordOf(page, "toInt");
    const auto nearest = [&](const char* place, std::size_t count) {
        return count == 1 ? std::string("0")
                          : fmt::format("{}(clamp(ceil(t.{} - 0.5001), 0.0, {}))", toInt, place,
                                        last(count));
    };
    page.set("firstGaussian",
             fmt::format("{} + ({} * {} + {}) * {}", lobes.nodes(), nearest("row", lobes.rows),
                         lobes.columns, nearest("column", lobes.columns), lobes.gaussians));
}

/// A sum over the eight texels around a place.
std::string blended(const char* texel, const char* lane) {
    std::vector<std::string> terms;
    for (int n = 0; n < 8; ++n) terms.push_back(fmt::format("s{} * {}{}.{}", n, texel, n, lane));
    return fmt::format("{}", fmt::join(terms, " + "));
}

void setMoments(const FilteredSidecar& map, const MapWords& words, data& page) {
    page.set("normalX", blended("a", "x"));
    page.set("normalY", blended("a", "y"));
    page.set("normalZ", blended("a", "z"));
    page.set("meanX", blended("a", "w"));
    page.set("meanY", blended("b", "x"));
    page.set("row", map.nodes.empty() ? "0.0" : blended("c", "w"));
    page.set("column", map.nodes.size() < 2
                           ? "0.0"
                           : fmt::format("{}_mapTexel({}uv, {}, level).x",
                                         gpu::wordOf(page, "prefix"), words.pass, momentLayers));
}

/// The terms of the lobe in a channel, where `weight(k)` names a weight times D.
template <class Weight>
std::string lobeSum(const FilteredSidecar& map, std::size_t channel, const Weight& weight) {
    std::vector<std::string> terms;
    for (std::size_t k = 0; k < map.terms.size(); ++k) {
        const LobeWeight& w = map.terms[k][channel];
        if (w.scale == 0) continue;
        const std::string scale = w.scale == 1 ? "" : fmt::format("{} * ", shaderNumber(w.scale));
        terms.push_back(fmt::format("{}m.{} * {}", scale, gpu::laneNames[k], weight(w.weight)));
    }
    return terms.empty() ? "0.0" : fmt::format("{}", fmt::join(terms, " + "));
}

void setOutputs(const FilteredSidecar& map, const MapWords& words, data& page) {
    const MipLayout& layout = map.layout;
    const auto albedo = [&](std::size_t c) {
        return static_cast<std::size_t>(
            layout.albedo(layout.albedos == 1 ? 0 : static_cast<int>(c)));
    };
    page.set("specular", layout.weights > 0);
    page.set("diffuse", layout.albedos > 0);
    data outputs = gpu::list(), albedos = gpu::list(), weights = gpu::list();
    std::vector<std::string> values;
    for (std::size_t c = 0; c < map.channels.count(); ++c) {
        std::string plain, filtered;
        if (layout.albedos > 0) {
            plain = fmt::format("s * {}", nameOf(albedo(c)));
            filtered = fmt::format("a{}", layout.albedos == 1 ? 0 : c);
        }
        if (layout.weights > 0) {
            const char* plus = plain.empty() ? "" : " + ";
            plain +=
                fmt::format("{}d * ({})", plus,
                            lobeSum(map, c, [](std::size_t k) { return nameOf(weightNumber(k)); }));
            filtered += plus + lobeSum(map, c, [](std::size_t k) { return fmt::format("d{}", k); });
        }
        data output;
        output.set("c", std::to_string(c));
        output.set("plain", plain.empty() ? "0.0" : plain);
        output.set("filtered", filtered.empty() ? "0.0" : filtered);
        outputs.push_back(output);
        values.push_back(fmt::format("q{}", c));
    }
    for (int k = 0; k < layout.albedos; ++k) {
        data row;
        std::vector<std::string> numbers;
        for (std::size_t i = 0; i < 9; ++i) numbers.push_back(nameOf(layout.albedo(k) + i));
        row.set("k", std::to_string(k));
        row.set("numbers", fmt::format("{}", fmt::join(numbers, ", ")));
        albedos.push_back(row);
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(layout.weights); ++k) {
        data row;
        row.set("k", std::to_string(k));
        row.set("density",
                map.form == "harmonics"
                    ? fmt::format("max({}_sum({}uv, lod, h, {}), 0.0)", gpu::wordOf(page, "prefix"),
                                  words.pass, k * evenSlots(layout.order))
                    : fmt::format("f.density * {}", nameOf(weightNumber(k))));
        weights.push_back(row);
    }
    page.set("outputs", outputs);
    page.set("albedos", albedos);
    page.set("weights", weights);
    const std::string list = fmt::format("{}", fmt::join(values, ", "));
    page.set("value",
             values.size() == 1 ? list : fmt::format("{}({})", gpu::wordOf(page, "vec3"), list));
}

/// Layers that the sampler blends, and the number of lookups.
void setLookups(const FilteredSidecar& map, const LobeNumbers& lobes, data& page) {
    const MipLayout& layout = map.layout;
    const bool harmonics = map.form == "harmonics";
    std::vector<std::size_t> plain, filtered;
    for (std::size_t k = 0; k < static_cast<std::size_t>(layout.weights); ++k) {
        plain.push_back(weightNumber(k));
        if (!harmonics) filtered.push_back(weightNumber(k));
    }
    for (int k = 0; k < layout.albedos; ++k) {
        plain.push_back(layout.albedo(k));
        for (std::size_t i = 0; i < 9; ++i) filtered.push_back(layout.albedo(k) + i);
    }
    page.set("plainLookups", layersOf(plain));
    page.set("lookups", layersOf(filtered));
    const std::size_t nodes = lobes.nodes() == 1 ? 0 : lobes.rows > 1 && lobes.columns > 1 ? 4 : 2;
    const std::size_t moments = 8 * momentLayers + (map.nodes.size() > 1 ? 1 : 0) + nodes;
    const auto count = [](const data& rows) { return rows.list_value().size(); };
    std::size_t all = moments + count(*page.get("lookups"));
    if (layout.weights > 0) all += lobes.gaussians;
    if (harmonics) {
        // Each band of a weight begins with a lookup of its own.
        for (std::size_t k = 0; k < static_cast<std::size_t>(layout.weights); ++k) {
            std::size_t number = k * evenSlots(layout.order);
            for (int l = 0; l < layout.order; l += 2) {
                const std::size_t end = number + static_cast<std::size_t>(2 * l + 1);
                all += (end - 1) / 4 - number / 4 + 1;
                number = end;
            }
        }
    }
    page.set("fetches", std::to_string(all));
    page.set("plainFetches", std::to_string(moments + count(*page.get("plainLookups"))));
}

void setHeader(const FilteredSidecar& map, data& page) {
    page.set("generator", gpu::commentText(map.generator));
    page.set("source", gpu::commentText(map.source));
    page.set("model", gpu::commentText(map.model));
    page.set("form", map.form == "harmonics"
                         ? fmt::format("harmonics of order {}", map.layout.order)
                         : map.form);
    page.set("order", std::to_string(map.layout.order));
    page.set("layers", std::to_string(map.layers()));
    page.set("number", gpu::numberName(map.number));
    page.set("mapWidthText", std::to_string(map.levels.front().width));
    page.set("mapHeightText", std::to_string(map.levels.front().height));
}

}  // namespace

std::string filteredShader(Language language, const FilteredSidecar& map, const LobeText& lobe,
                           const FilteredShaderOptions& options) {
    gpu::checkPrefix(options.prefix);
    checkLayers(language, "the map", map.layers(), "fewer weights and albedos have fewer");
    checkLayers(language, "the texture of harmonics", map.harmonicLayers(),
                "the form ellipse has none, and harmonics of a lower order have fewer");
    const LobeNumbers lobes = lobeNumbers(map);
    data page;
    gpu::setLanguageWords(language, options.prefix, page);
    gpu::setChannelWords(map.channels, page);
    const MapWords words = setMapTextures(language,
                                          {.levels = map.levels,
                                           .shared = &lobes.texels,
                                           .harmonics = map.harmonicLevels(),
                                           .wrap = options.wrap},
                                          page);
    page.set("fetch", texelFetchText(language, options.prefix, words.pass, "layer"));
    page.set("finalLevel", fmt::format("{}.0", mostLevel(language, map.levels)));
    page.set("levelled", map.levels.size() > 1);
    setHeader(map, page);
    setFunctions(language, page);
    setLobe(lobe, page);
    setNodes(map, lobes, page);
    setMoments(map, words, page);
    setOutputs(map, words, page);
    setLookups(map, lobes, page);
    gpu::setSharedPartials(page);
    setPartials({{"header", embedded::filtered_header},
                 {"mapFunctions", embedded::filtered_functions},
                 {"texelFunctions", embedded::filtered_texel},
                 {"facetFunctions", embedded::filtered_facets},
                 {"harmonicFunctions", embedded::filtered_harmonics},
                 {"valueFunctions", embedded::filtered_value}},
                page);
    return gpu::rendered(words.text, page);
}

}  // namespace hshfit::inline filtered_maps::inline exports
