#include <hshfit/library_maps/exports/library_map_shader.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/forms/table_text.h>
#include <hshfit/gpu/language_words.h>
#include <hshfit/gpu/shader_data.h>
#include <hshfit/gpu/shader_text.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/material_library/shared_functions.h>
#include <hshfit/material_maps/exports/map_text.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view library_map_header, library_map_value;
}  // namespace hshfit::embedded

namespace hshfit::inline library_maps::inline exports {
namespace {

namespace ml = material_library;
using gpu::Language;
using kainjow::mustache::data;

constexpr std::size_t triedSide = 8;  ///< texels of level 0 along a side that errors are of

/// The numbers of a texel as SharedSums has them without a table.
void appendTexel(const LibraryLayout& layout, const std::vector<double>& numbers,
                 std::vector<double>& materials) {
    const auto colour = [&](const auto& numberOf) {
        for (std::size_t c = 0; c < 3; ++c)
            materials.push_back(numberOf(layout.channels == 1 ? 0 : c));
        materials.push_back(0);
    };
    for (std::size_t k = 1; k <= layout.components; ++k)
        colour([&](std::size_t c) { return numbers[layout.factor(c, k)]; });
    colour([&](std::size_t c) { return numbers[layout.bound(c)]; });
}

/// The same with a table: a row of LibraryLayout in three channels.
std::vector<double> tabledTexel(const LibraryLayout& layout, const std::vector<double>& numbers) {
    const LibraryLayout colours{3, layout.components};
    std::vector<double> texel(4 * colours.layers(), 0.0);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t from = layout.channels == 1 ? 0 : c;
        texel[colours.bound(c)] = numbers[layout.bound(from)];
        for (std::size_t k = 0; k < 4 * layout.groups(); ++k)
            texel[colours.factor(c, k)] = numbers[layout.factor(from, k)];
    }
    texel[3] = static_cast<double>(layout.groups());
    return texel;
}

gpu::SharedSums sumsOf(const LibraryMap& map) {
    const LibrarySidecar& s = map.sidecar();
    gpu::SharedSums sums{.functions = ml::sharedFunctions(map.basis()),
                         .offset = ml::logOffset,
                         .topFirst = std::log(ml::logOffset),
                         .topStep = 1 / ml::topsPerLog,
                         .parts = {},
                         .materials = {}};
    for (std::size_t k = 1; k <= s.layout.components; ++k) sums.parts.push_back({k, 1});
    for (std::size_t level = 0; level < s.levels.size(); ++level) {
        const auto [width, height] = s.levels[level];
        const std::size_t side = level == 0 ? triedSide : 1, columns = std::min(side, width),
                          rows = std::min(side, height);
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < columns; ++c)
                appendTexel(s.layout,
                            map.numbers(level, (2 * c + 1) * width / (2 * columns),
                                        (2 * r + 1) * height / (2 * rows)),
                            sums.materials);
    }
    return sums;
}

}  // namespace

MapFunctions tabledFunctions(const LibraryMap& map, double largest) {
    gpu::TabledLibrary tabled = gpu::tabledWithin(sumsOf(map), largest);
    return {std::move(tabled.sums), tabled.error};
}

std::vector<double> mapValue(const LibraryMap& map, const MapFunctions& functions,
                             const MapPlace& place, Wrap wrap, const Direction& wo,
                             const Direction& wi) {
    const LibrarySidecar& s = map.sidecar();
    std::vector<double> numbers(4 * s.layout.layers(), 0.0);
    for (const MapCorner& corner : mapCorners(s.levels, place, wrap)) {
        const std::vector<double> texel = map.numbers(corner.level, corner.column, corner.row);
        for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] += corner.share * texel[k];
    }
    gpu::SharedSums sums = functions.sums;
    sums.materials = tabledTexel(s.layout, numbers);
    std::vector<double> f(3);
    gpu::TabledBrdf(sums, 0).eval(wo, {&wi.x, &wi.y, &wi.z, 1}, f.data());
    f.resize(s.layout.channels);
    return f;
}

std::string libraryMapShader(Language language, const LibraryMap& map,
                             const MapFunctions& functions, const MapShaderOptions& options) {
    const LibrarySidecar& s = map.sidecar();
    gpu::checkPrefix(options.prefix);
    checkLayers(language, "the map", s.layout.layers(), "fewer components have fewer");
    const gpu::FunctionTable& table = *functions.sums.table;
    gpu::Payload head;
    head.head.channels = s.channels;
    data page;
    gpu::setWords(language, head, options.prefix, page);
    const LevelSize size[] = {{static_cast<std::size_t>(table.texels().width),
                               static_cast<std::size_t>(table.texels().height)}};
    const MapWords words = setMapTextures(
        language, {.levels = s.levels, .harmonics = size, .wrap = options.wrap}, page);
    const std::size_t groups = s.layout.groups();
    const auto number = [&](const char* name, double value) {
        page.set(name, gpu::shaderNumber(value));
    };
    page.set("generator", gpu::commentText(s.generator));
    page.set("source", gpu::commentText(s.source));
    page.set("layers", std::to_string(s.layout.layers()));
    page.set("number", gpu::numberName(s.number));
    page.set("components", std::to_string(s.layout.components));
    page.set("channelNames", fmt::format("{}", fmt::join(s.channels.names(), " ")));
    page.set("groups", std::to_string(groups));
    page.set("evalFetches", std::to_string(1 + (2 + s.layout.channels) * groups));
    page.set("evalProducts",
             std::to_string(gpu::tableProducts + (4 + 4 * s.layout.channels) * groups));
    page.set("shade", false);
    number("topScale", functions.sums.topStep);
    number("topFirst", functions.sums.topFirst);
    const std::string offset = gpu::shaderNumber(functions.sums.offset);
    page.set("offsets", s.layout.channels == 1
                            ? offset
                            : fmt::format("{}({}, {}, {})", gpu::wordOf(page, "vec3"), offset,
                                          offset, offset));
    gpu::setTablePlace(table, page);
    gpu::setSharedPartials(page);
    setPartials(
        {{"header", embedded::library_map_header}, {"mapEval", embedded::library_map_value}}, page);
    setMapFunctions(page);
    return gpu::rendered(words.text, page);
}

}  // namespace hshfit::inline library_maps::inline exports
