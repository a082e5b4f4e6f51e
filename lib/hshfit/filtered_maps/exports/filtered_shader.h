#pragma once

#include <hshfit/filtered_maps/exports/lobe_text.h>
#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/material_maps/exports/map_shader.h>

#include <string>

namespace hshfit::inline filtered_maps::inline exports {

struct FilteredShaderOptions {
    std::string prefix = "hsh";  ///< of every name
    Wrap wrap = Wrap::clamp;     ///< beyond the edge, for the texels that the shader blends itself
};

/// A snippet for a map of filtered lobes, beside its textures and LobeNumbers:
///     PREFIX_eval(uv, lod, wo, wi)  f cos(theta_i) as FilteredSampler gives it
///     PREFIX_level(dx, dy)          the level where uv changes by dx and dy from pixel to pixel
/// Throws UsageError for a map that the language cannot take, with the reason.
std::string filteredShader(gpu::Language language, const FilteredSidecar& map, const LobeText& lobe,
                           const FilteredShaderOptions& options);

}  // namespace hshfit::inline filtered_maps::inline exports
