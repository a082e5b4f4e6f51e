#include <hshfit/material_maps/exports/map_shader.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/material_maps/exports/internal/weighted_sums.h>
#include <hshfit/material_maps/exports/shared_numbers.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace hshfit::embedded {
extern const std::string_view map_corners, map_eval, map_functions, map_glsl, map_header, map_hlsl,
    map_level, map_material, map_metal, map_node, map_osl, map_shade, map_sums, map_wgsl;
}  // namespace hshfit::embedded

namespace hshfit::inline material_maps::inline exports {
namespace {

using gpu::Language;
using gpu::shaderNumber;
using kainjow::mustache::data;
using kainjow::mustache::partial;

constexpr int maxEnvironmentOrder = 16;

/// The words that maps need of a language beyond gpu::setWords.
struct MapLanguage {
    std::string_view text, letInt, toInt;
    std::string parameters = {}, pass = {};  ///< textures as arguments
};

MapLanguage mapLanguage(Language language, const MapSidecar& map) {
    const bool sharing = map.form != "outgoing", clusters = map.form == "clusters";
    switch (language) {
        case Language::glslEs:
        case Language::glsl:
            return {embedded::map_glsl, "int", "int"};
        case Language::hlsl:
            return {embedded::map_hlsl, "int", "int"};
        case Language::wgsl:
            return {embedded::map_wgsl, "let", "i32"};
        case Language::metal:
            return {embedded::map_metal, "int", "int",
                    fmt::format("texture2d_array<float> map, {}{}",
                                clusters ? "" : "sampler mapSampler, ",
                                sharing ? "texture2d_array<float> numbers, " : ""),
                    fmt::format("map, {}{}", clusters ? "" : "mapSampler, ",
                                sharing ? "numbers, " : "")};
        case Language::osl:
            break;
    }
    return {embedded::map_osl, "int", "(int)",
            sharing ? "string map, string numbers, " : "string map, ",
            sharing ? "map, numbers, " : "map, "};
}

/// A payload without texels: what the parts of snippets ask of one.
gpu::Payload headOf(const MapSidecar& map) {
    gpu::Payload payload;
    payload.head.basis = map.basis;
    payload.head.order = map.order;
    payload.head.quantity = map.quantity;
    payload.head.channels = map.channels;
    payload.head.outgoing = map.layout.outgoing;
    payload.slots = map.layout.slots;
    payload.toChannels.resize(map.channels.count());
    return payload;
}

struct Node {
    std::string cell, share;  ///< empty: there is one node
};

std::vector<Node> nodesOf(const OutgoingSet& set) {
    if (set.map == OutgoingSet::Map::direction) return {{"", "1.0"}};
    const std::string columns[] = {"1.0 - partX", "partX"}, rows[] = {"1.0 - partY", "partY"};
    const int right = set.width > 1 ? 1 : 0, below = set.height > 1 ? set.width : 0;
    std::vector<Node> nodes;
    if (set.map == OutgoingSet::Map::elevations) {
        for (int i : {0, 1}) nodes.push_back({std::to_string(i * right), columns[i]});
        return nodes;
    }
    for (int j : {0, 1}) {
        for (int i : {0, 1}) {
            nodes.push_back({std::to_string(j * below + i * right),
                             fmt::format("({}) * ({})", rows[j], columns[i])});
        }
    }
    return nodes;
}

void setNodes(const OutgoingSet& set, std::size_t groups, data& page) {
    gpu::setMap(set, page);
    const auto number = [&](const char* name, double value) {
        page.set(name, shaderNumber(value));
    };
    number("nodeScale", set.width - 0.5);
    number("lastX", set.width - 1);
    number("lastY", set.height - 1);
    number("innerX", set.width - 2);
    number("innerY", set.height - 2);
    number("cellX", std::max(set.width - 2, 0));
    number("cellY", std::max(set.height - 2, 0));
    page.set("width", std::to_string(set.width));
    page.set("groups", std::to_string(groups));
    data rows = gpu::list();
    const std::vector<Node> nodes = nodesOf(set);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        data row;
        row.set("k", std::to_string(k));
        if (nodes[k].cell.empty())
            row.set("cell", false);
        else
            row.set("cell", nodes[k].cell);
        row.set("share", nodes[k].share);
        rows.push_back(row);
    }
    page.set("nodes", rows);
}

/// The four texels of each of two levels.
void setCorners(data& page) {
    data levels = gpu::list();
    int n = 0;
    for (int k : {0, 1}) {
        data corners = gpu::list();
        for (int j : {0, 1}) {
            for (int i : {0, 1}) {
                data corner;
                corner.set("n", std::to_string(n++));
                corner.set("i", std::to_string(i));
                corner.set("j", std::to_string(j));
                corner.set(
                    "part",
                    fmt::format("{} * {} * {}", k ? "between" : "(1.0 - between)",
                                fmt::format(fmt::runtime(i ? "partU{}" : "(1.0 - partU{})"), k),
                                fmt::format(fmt::runtime(j ? "partV{}" : "(1.0 - partV{})"), k)));
                corners.push_back(corner);
            }
        }
        data level;
        level.set("k", std::to_string(k));
        level.set("corners", corners);
        levels.push_back(level);
    }
    page.set("levels", levels);
}

std::vector<std::string> named(const char* name, std::size_t count) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < count; ++k) names.push_back(fmt::format("{}{}", name, k));
    return names;
}

/// Sums of a function: of the numbers b of `eval`, or of e, which have a lane for each colour.
data sumsOf(const MapSidecar& map, const std::string& prefix, const std::string& pass, bool light,
            gpu::ShaderCost& cost) {
    const bool grey = map.channels.count() == 1, sharing = map.form != "outgoing";
    const std::size_t slots = map.layout.slots.size(), rank = sharing ? map.rank() : 0;
    const auto texel = [&](std::string place) {
        return fmt::format("{}_mapTexel({}uv, {}, lod)", prefix, pass, place);
    };
    const auto number = [&](std::string place) {
        return fmt::format("{}_sharedTexel({}{})", prefix, pass, place);
    };
    const auto function = [light](std::size_t i, std::size_t colour) {
        return light ? fmt::format("e{}.{}", i, gpu::laneNames[colour]) : fmt::format("b{}", i);
    };
    using Colours = std::vector<std::size_t>;
    const Colours all = light ? Colours{0, 1, 2} : Colours{0};
    // A channel meets the light of its own colour.
    const auto channelColours = [=](std::size_t c) { return light && !grey ? Colours{c} : all; };
    const auto output = [=](std::size_t c, std::size_t colour) {
        return fmt::format("q{}", light && grey ? colour : c);
    };
    const std::size_t nodes = nodesOf(map.layout.outgoing).size();
    data list = gpu::list();
    WeightedSums first{
        .outs = map.channels.count(),
        .ins = slots,
        .texel = "x",
        .factors = named("share", nodes),
        .fetch = [&](std::size_t k,
                     std::size_t group) { return texel(fmt::format("node{} + {}", k, group)); },
        .from = function,
        .to = output,
        .coloursOf = channelColours};
    if (nodes == 1) first.factors = {""};
    if (!sharing) {
        list.push_back(sumsData(first, cost));
        return list;
    }
    const auto shape = [light](std::size_t r, std::size_t colour) {
        return light ? fmt::format("g{}_{}", r, colour) : fmt::format("g{}", r);
    };
    first.outs = rank;
    first.fetch = [&](std::size_t k, std::size_t group) {
        return number(fmt::format("node{} + {}", k, group));
    };
    first.to = shape;
    first.coloursOf = [&](std::size_t) { return all; };
    list.push_back(sumsData(first, cost));
    WeightedSums weights{
        .outs = map.channels.count(),
        .ins = rank,
        .texel = "y",
        .factors = {""},
        .fetch = [&](std::size_t, std::size_t group) { return texel(std::to_string(group)); },
        .from = shape,
        .to = output,
        .coloursOf = channelColours};
    if (map.form == "clusters") {
        weights.factors = named("part", 8);
        weights.fetch = [&](std::size_t k, std::size_t group) {
            return number(fmt::format("corner{} + {}", k, group));
        };
        cost.fetches += 8;
    }
    list.push_back(sumsData(weights, cost));
    return list;
}

/// The texel of an index texture at (px, py) of `level`.
std::string indexFetch(Language language, const std::string& prefix, const std::string& pass) {
    switch (language) {
        case Language::glslEs:
        case Language::glsl:
            return fmt::format("texelFetch({}_map, ivec3(int(px), int(py), 0), int(level))",
                               prefix);
        case Language::hlsl:
            return fmt::format("{}_map.Load(int4(int(px), int(py), 0, int(level)))", prefix);
        case Language::wgsl:
            return fmt::format("textureLoad({}_map, vec2<i32>(i32(px), i32(py)), 0, i32(level))",
                               prefix);
        case Language::metal:
            return "map.read(uint2(uint(px), uint(py)), 0, uint(level))";
        case Language::osl:
            break;
    }
    return fmt::format("{0}_mapTexel({1}{0}_Two((px + 0.5) / wide, (py + 0.5) / high), 0, level)",
                       prefix, pass);
}

void setSizes(const MapSidecar& map, const MapShaderOptions& options, data& page) {
    const LevelSize& size = map.levels.front();
    const auto real = [&](const char* name, std::size_t value) {
        page.set(name, fmt::format("{}.0", value));
    };
    real("mapWidth", size.width);
    real("mapHeight", size.height);
    real("mapSide", std::min(size.width, size.height));
    real("lastLevel", map.levels.size() - 1);
    real("oslLevel", mostLevel(Language::osl, map));
    page.set("levelCount", std::to_string(map.levels.size()));
    page.set("repeat", options.wrap == Wrap::repeat);
    page.set("oslWrap", options.wrap == Wrap::repeat ? "periodic" : "clamp");
    page.set("clusters", map.form == "clusters");
    page.set("sharing", map.form != "outgoing");
    if (map.form == "outgoing") return;
    const SharedNumbers shared = sharedNumbers(map);
    page.set("sharedWidth", std::to_string(SharedNumbers::width));
    real("sharedRows", static_cast<std::size_t>(shared.texels.height));
    page.set("firstMaterial", std::to_string(shared.firstMaterial));
    page.set("groupsOfMaterial", std::to_string(shared.groupsOfMaterial));
}

void setHeader(const MapSidecar& map, data& page) {
    page.set("generator", gpu::commentText(map.generator));
    page.set("source", gpu::commentText(map.source));
    page.set("layers", std::to_string(map.layers()));
    page.set("number", gpu::numberName(map.number));
    page.set("form", map.form);
    page.set("basis", map.basis);
    page.set("order", std::to_string(map.order));
    page.set("functionCount", std::to_string(map.layout.slots.size()));
    page.set("condonShortley", false);
    page.set("channelNames", fmt::format("{}", fmt::join(map.channels.names(), " ")));
    page.set("outgoing", map.layout.outgoing.spec());
    page.set("cosine", map.quantity == Quantity::brdfCosine);
}

void setLight(Language language, const MapShaderOptions& options, data& page) {
    page.set("shade", options.environmentOrder > 0);
    const std::string count = std::to_string(options.environmentOrder * options.environmentOrder);
    page.set("environmentCount", count);
    const std::string vector = page.get("vec3")->string_value();
    const auto declared = [&](const char* name) {
        return language == Language::metal ? fmt::format("{}_Environment {}", options.prefix, name)
                                           : fmt::format("{} {}[{}]", vector, name, count);
    };
    page.set("envParameter", declared("env"));
    page.set("envLocal", declared("env"));
    page.set("lightParameter", declared("light"));
}

void setMapPartials(data& page) {
    gpu::setPartials(page);
    const std::pair<const char*, std::string_view> parts[] = {
        {"header", embedded::map_header},         {"nodeBody", embedded::map_node},
        {"cornersBody", embedded::map_corners},   {"materialBody", embedded::map_material},
        {"sumsBody", embedded::map_sums},         {"mapEval", embedded::map_eval},
        {"mapShade", embedded::map_shade},        {"levelBody", embedded::map_level},
        {"mapFunctions", embedded::map_functions}};
    for (const auto& [name, text] : parts) {
        std::string body(text);
        if (body.ends_with('\n')) body.pop_back();
        page.set(name, data(partial([body] { return body; })));
    }
}

std::string_view nameOf(Language language) {
    return std::ranges::find(gpu::languages(), language, &gpu::LanguageEntry::language)->name;
}

void check(Language language, const MapSidecar& map, const MapShaderOptions& options) {
    gpu::checkPrefix(options.prefix);
    if (options.environmentOrder < 0 || options.environmentOrder > maxEnvironmentOrder) {
        throw UsageError(fmt::format("environment of order {}; it has to be 0 (none) to {}",
                                     options.environmentOrder, maxEnvironmentOrder));
    }
    if (map.layers() > mostLayers(language)) {
        throw UsageError(fmt::format(
            "the map has {} layers; a texture of {} has at most {}; fewer outgoing directions, a "
            "lower order or the form low-rank have fewer",
            map.layers(), nameOf(language), mostLayers(language)));
    }
}

}  // namespace

std::string_view wrapName(Wrap wrap) {
    return wrap == Wrap::clamp ? "clamp" : "repeat";
}

Wrap parseWrap(std::string_view name) {
    for (const Wrap wrap : {Wrap::clamp, Wrap::repeat})
        if (name == wrapName(wrap)) return wrap;
    throw UsageError(fmt::format("unknown wrap '{}'; known: clamp, repeat", name));
}

std::size_t mostLayers(Language language) {
    if (language == Language::osl) return std::size_t{1} << 16;
    return language == Language::glslEs || language == Language::wgsl ? gpu::maxLayers : 2048;
}

std::size_t mostLevel(Language language, const MapSidecar& map) {
    std::size_t level = map.levels.size() - 1;
    if (language != Language::osl) return level;
    const auto shorter = [&](std::size_t k) {
        return std::min(map.levels[k].width, map.levels[k].height);
    };
    while (level > 0 && shorter(level - 1) == 1) --level;
    return level;
}

std::string mapShader(Language language, const MapSidecar& map, const MapShaderOptions& options) {
    check(language, map, options);
    const MapLanguage words = mapLanguage(language, map);
    const gpu::Payload payload = headOf(map);
    const auto basis = bases::make(map.basis, map.order);
    data page;
    gpu::setWords(language, payload, options.prefix, page);
    page.set("letInt", std::string(words.letInt));
    page.set("toInt", std::string(words.toInt));
    page.set("parameters", words.parameters);
    page.set("pass", words.pass);
    page.set("inline", language == Language::metal ? "inline " : "");
    page.set("es", language == Language::glslEs);
    page.set("fetch", indexFetch(language, options.prefix, words.pass));
    setHeader(map, page);
    setSizes(map, options, page);
    setCorners(page);
    const std::size_t groups = map.form == "outgoing"
                                   ? map.layout.groups()
                                   : (map.rank() * map.layout.slots.size() + 3) / 4;
    setNodes(map.layout.outgoing, groups, page);
    gpu::ShaderCost eval, shade, world;
    gpu::setBasis(payload, *basis, page, eval);
    page.set("evalSums", sumsOf(map, options.prefix, words.pass, false, eval));
    setLight(language, options, page);
    if (options.environmentOrder > 0) {
        gpu::setShading(payload, *basis, options.environmentOrder, false, page, shade);
        page.set("shadeSums", sumsOf(map, options.prefix, words.pass, true, shade));
        gpu::setFrameTurn(payload, options.environmentOrder, false, page, world);
    }
    const auto cost = [&](const std::string& name, const gpu::ShaderCost& of) {
        page.set(name + "Fetches", std::to_string(of.fetches));
        page.set(name + "Products", std::to_string(of.products));
    };
    cost("eval", eval);
    cost("shade", shade);
    cost("world", world);
    setMapPartials(page);
    return gpu::rendered(words.text, page);
}

}  // namespace hshfit::inline material_maps::inline exports
