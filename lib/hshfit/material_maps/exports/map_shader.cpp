#include <hshfit/material_maps/exports/map_shader.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/language_words.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/material_maps/exports/internal/weighted_sums.h>
#include <hshfit/material_maps/exports/map_text.h>
#include <hshfit/material_maps/exports/shared_numbers.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

namespace hshfit::embedded {
extern const std::string_view map_corners, map_eval, map_header, map_material, map_node, map_shade,
    map_sums;
}  // namespace hshfit::embedded

namespace hshfit::inline material_maps::inline exports {
namespace {

using gpu::Language;
using gpu::shaderNumber;
using kainjow::mustache::data;

constexpr int maxEnvironmentOrder = 16;

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

std::vector<std::string> named(const char* name, std::size_t count) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < count; ++k) names.push_back(fmt::format("{}{}", name, k));
    return names;
}

/// Sums of a function: of the numbers b of `eval`, or, where `lit` has the functions that the light
/// meets, of e, which have a lane for each colour.
data sumsOf(const MapSidecar& map, const std::string& prefix, const std::string& pass,
            const std::optional<std::vector<std::size_t>>& lit, gpu::ShaderCost& cost) {
    const bool light = lit.has_value();
    const bool grey = map.channels.count() == 1, sharing = map.form != "outgoing";
    const std::size_t slots = map.layout.slots.size(), rank = sharing ? map.rank() : 0;
    const auto texel = [&](std::string place) {
        return fmt::format("{}_mapTexel({}uv, {}, lod)", prefix, pass, place);
    };
    const auto number = [&](std::string place) {
        return fmt::format("{}_sharedTexel({}{})", prefix, pass, place);
    };
    const auto function = [&](std::size_t i, std::size_t colour) {
        if (!light) return fmt::format("b{}", i);
        const bool met = std::ranges::binary_search(*lit, i);
        return met ? fmt::format("e{}.{}", i, gpu::laneNames[colour]) : std::string("0.0");
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

/// Sizes of what the texels share.
void setSharing(const MapSidecar& map, data& page) {
    page.set("clusters", map.form == "clusters");
    if (map.form == "outgoing") return;
    const SharedNumbers shared = sharedNumbers(map);
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
    page.set("outgoing", map.layout.outgoing.spec());
    page.set("cosine", map.quantity == Quantity::brdfCosine);
}

void setLight(Language language, const MapShaderOptions& options, data& page) {
    page.set("shade", options.environmentOrder > 0);
    const std::string count = std::to_string(options.environmentOrder * options.environmentOrder);
    page.set("environmentCount", count);
    const std::string vector = gpu::wordOf(page, "vec3");
    const auto declared = [&](const char* name) {
        return language == Language::metal ? fmt::format("{}_Environment {}", options.prefix, name)
                                           : fmt::format("{} {}[{}]", vector, name, count);
    };
    page.set("envParameter", declared("env"));
    page.set("envLocal", declared("env"));
    page.set("lightParameter", declared("light"));
}

void setMapPartials(data& page) {
    gpu::setSharedPartials(page);
    setPartials({{"header", embedded::map_header},
                 {"nodeBody", embedded::map_node},
                 {"cornersBody", embedded::map_corners},
                 {"materialBody", embedded::map_material},
                 {"sumsBody", embedded::map_sums},
                 {"mapEval", embedded::map_eval},
                 {"mapShade", embedded::map_shade}},
                page);
    setMapFunctions(page);
}

void check(Language language, const MapSidecar& map, const MapShaderOptions& options) {
    gpu::checkPrefix(options.prefix);
    if (options.environmentOrder < 0 || options.environmentOrder > maxEnvironmentOrder) {
        throw UsageError(fmt::format("environment of order {}; it has to be 0 (none) to {}",
                                     options.environmentOrder, maxEnvironmentOrder));
    }
    checkLayers(language, "the map", map.layers(),
                "fewer outgoing directions, a lower order or the form low-rank have fewer");
}

}  // namespace

std::string mapShader(Language language, const MapSidecar& map, const MapShaderOptions& options) {
    check(language, map, options);
    const gpu::Payload payload = headOf(map);
    const auto basis = bases::make(map.basis, map.order);
    data page;
    gpu::setWords(language, payload, options.prefix, page);
    std::optional<SharedNumbers> shared;
    if (map.form != "outgoing") shared = sharedNumbers(map);
    const MapWords words = setMapTextures(language,
                                          {.levels = map.levels,
                                           .sampled = map.form != "clusters",
                                           .shared = shared ? &shared->texels : nullptr,
                                           .wrap = options.wrap},
                                          page);
    page.set("fetch", texelFetchText(language, options.prefix, words.pass, "0"));
    setHeader(map, page);
    setSharing(map, page);
    const std::size_t groups = map.form == "outgoing"
                                   ? map.layout.groups()
                                   : (map.rank() * map.layout.slots.size() + 3) / 4;
    setNodes(map.layout.outgoing, groups, page);
    gpu::ShaderCost eval, shade, world;
    gpu::setBasis(payload, *basis, page, eval);
    page.set("evalSums", sumsOf(map, options.prefix, words.pass, {}, eval));
    setLight(language, options, page);
    if (options.environmentOrder > 0) {
        const auto lit =
            gpu::setShading(payload, *basis, options.environmentOrder, false, page, shade);
        page.set("shadeSums", sumsOf(map, options.prefix, words.pass, lit, shade));
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
