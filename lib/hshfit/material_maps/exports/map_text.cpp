#include <hshfit/material_maps/exports/map_text.h>

#include <hshfit/error.h>
#include <hshfit/files/template_text.h>
#include <hshfit/gpu/language_words.h>
#include <hshfit/gpu/shader_data.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::embedded {
extern const std::string_view map_functions, map_functions_wgsl, map_glsl, map_hlsl, map_level,
    map_metal, map_osl, map_wgsl;
}  // namespace hshfit::embedded

namespace hshfit::inline material_maps::inline exports {
namespace {

using gpu::Language;
using kainjow::mustache::data;

std::string_view nameOf(Language language) {
    return std::ranges::find(gpu::languages(), language, &gpu::LanguageEntry::language)->name;
}

/// Textures that functions take as arguments, where they are no globals.
MapWords wordsOf(Language language, const MapTextures& textures) {
    MapWords words{
        gpu::textOf(language, {embedded::map_glsl, embedded::map_glsl, embedded::map_hlsl,
                               embedded::map_wgsl, embedded::map_metal, embedded::map_osl})};
    const auto add = [&](const char* type, const char* name) {
        words.parameters += fmt::format("{} {}, ", type, name);
        words.pass += fmt::format("{}, ", name);
    };
    if (language != Language::metal && language != Language::osl) return words;
    const bool metal = language == Language::metal;
    const char* texture = metal ? "texture2d_array<float>" : "string";
    add(texture, "map");
    if (metal && textures.sampled) add("sampler", "mapSampler");
    if (textures.shared) add(texture, "numbers");
    if (!textures.harmonics.empty()) add(texture, "harmonics");
    return words;
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

std::string real(std::size_t value) {
    return fmt::format("{}.0", value);
}

std::size_t shorterSide(const LevelSize& size) {
    return std::min(size.width, size.height);
}

void setSizes(const MapTextures& textures, data& page) {
    const LevelSize& size = textures.levels.front();
    page.set("mapWidth", real(size.width));
    page.set("mapHeight", real(size.height));
    page.set("mapSide", real(shorterSide(size)));
    page.set("lastLevel", real(textures.levels.size() - 1));
    page.set("oslLevel", real(mostLevel(Language::osl, textures.levels)));
    page.set("levelCount", std::to_string(textures.levels.size()));
    page.set("repeat", textures.wrap == Wrap::repeat);
    page.set("oslWrap", textures.wrap == Wrap::repeat ? "periodic" : "clamp");
    page.set("clusters", !textures.sampled);
    page.set("sharing", textures.shared != nullptr);
    if (textures.shared) {
        page.set("sharedWidth", std::to_string(textures.shared->width));
        page.set("sharedRows", real(static_cast<std::size_t>(textures.shared->height)));
    }
    page.set("harmonics", !textures.harmonics.empty());
    if (textures.harmonics.empty()) return;
    page.set("harmonicsSide", real(shorterSide(textures.harmonics.front())));
    page.set("oslHarmonicsLevel", real(mostLevel(Language::osl, textures.harmonics)));
}

}  // namespace

MapWords setMapTextures(Language language, const MapTextures& textures, data& page) {
    const MapWords words = wordsOf(language, textures);
    page.set("parameters", words.parameters);
    page.set("pass", words.pass);
    setSizes(textures, page);
    setCorners(page);
    setPartials({{"levelBody", embedded::map_level}}, page);
    return words;
}

void setMapFunctions(data& page) {
    const bool wgsl = page.get("wgsl")->is_true();
    setPartials({{"mapFunctions", wgsl ? embedded::map_functions_wgsl : embedded::map_functions}},
                page);
}

std::string texelFetchText(Language language, const std::string& prefix, const std::string& pass,
                           const std::string& layer) {
    constexpr const char* glsl = "texelFetch({0}_map, ivec3(int(px), int(py), {2}), int(level))";
    const std::string_view form = gpu::textOf(
        language,
        {.glslEs = glsl,
         .glsl = glsl,
         .hlsl = "{0}_map.Load(int4(int(px), int(py), {2}, int(level)))",
         .wgsl = "textureLoad({0}_map, vec2<i32>(i32(px), i32(py)), {2}, i32(level))",
         .metal = "map.read(uint2(uint(px), uint(py)), {2}, uint(level))",
         .osl = "{0}_mapTexel({1}{0}_Two((px + 0.5) / wide, (py + 0.5) / high), {2}, level)"});
    return fmt::format(fmt::runtime(form), prefix, pass, layer);
}

void checkLayers(Language language, std::string_view what, std::size_t layers,
                 std::string_view instead) {
    if (layers <= mostLayers(language)) return;
    throw UsageError(fmt::format("{} has {} layers; a texture of {} has at most {}; {}", what,
                                 layers, nameOf(language), mostLayers(language), instead));
}

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

std::size_t mostLevel(Language language, std::span<const LevelSize> levels) {
    std::size_t level = levels.size() - 1;
    if (language != Language::osl) return level;
    const auto shorter = [&](std::size_t k) { return std::min(levels[k].width, levels[k].height); };
    while (level > 0 && shorter(level - 1) == 1) --level;
    return level;
}

}  // namespace hshfit::inline material_maps::inline exports
