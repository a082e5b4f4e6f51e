#pragma once

#include <hshfit/gpu/texels.h>
#include <hshfit/material_maps/exports/map_shader.h>

#include <kainjow/mustache.hpp>

#include <span>
#include <string>
#include <string_view>

namespace hshfit::inline material_maps::inline exports {

/// The textures that a snippet of a map declares.
struct MapTextures {
    std::span<const LevelSize> levels;
    bool sampled = true;                  ///< with a linear filter: PREFIX_mapTexel(uv, layer, lod)
    const gpu::Texels* shared = nullptr;  ///< PREFIX_sharedTexel(n), quadruple n
    std::span<const LevelSize> harmonics = {};  ///< PREFIX_harmonicTexel(uv, layer, lod)
    Wrap wrap = Wrap::clamp;
};

/// The template of a snippet in a language, with the partials "header" and "mapFunctions", and the
/// textures as parameters and arguments of functions.
struct MapWords {
    std::string_view text;
    std::string parameters = {}, pass = {};
};
/// Sets what the template needs beyond gpu::setLanguageWords, sizes, the corners of two levels, and
/// the partial "levelBody".
MapWords setMapTextures(gpu::Language language, const MapTextures& textures,
                        kainjow::mustache::data& page);

/// Sets the partial "mapFunctions": PREFIX_evalRaw, whose body is the partial "mapEval",
/// PREFIX_eval, PREFIX_level, and, with the key "shade", the functions for light.
void setMapFunctions(kainjow::mustache::data& page);

/// The texel of the map at column px and row py of `level` without a filter, in the layer that an
/// expression names.
std::string texelFetchText(gpu::Language language, const std::string& prefix,
                           const std::string& pass, const std::string& layer);

/// Throws UsageError where a texture of the language has fewer layers; `instead` has fewer.
void checkLayers(gpu::Language language, std::string_view what, std::size_t layers,
                 std::string_view instead);

}  // namespace hshfit::inline material_maps::inline exports
