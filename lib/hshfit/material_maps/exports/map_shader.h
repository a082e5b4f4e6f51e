#pragma once

#include <hshfit/gpu/shader.h>
#include <hshfit/material_maps/map_sidecar.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::inline material_maps::inline exports {

/// The texel that is taken beyond the edge of a map.
enum class Wrap {
    clamp,   ///< the nearest of the edge
    repeat,  ///< the map goes on from the other side
};
std::string_view wrapName(Wrap wrap);   ///< "clamp", "repeat"
Wrap parseWrap(std::string_view name);  ///< throws UsageError

struct MapShaderOptions {
    std::string prefix = "hsh";  ///< of every name
    int environmentOrder = 5;    ///< of the light that `shade` takes; 0: no `shade`
    /// For clusters, whose texels the shader blends itself; others leave it to their sampler.
    Wrap wrap = Wrap::clamp;
};

/// The most layers of a texture array: 256 in WebGL 2 and WebGPU, 2048 in Direct3D 11, Vulkan on
/// desktops and Metal; none in OSL.
std::size_t mostLayers(gpu::Language language);

/// The coarsest level that a shader reads: the last, but in OSL the first whose shorter side is 1.
std::size_t mostLevel(gpu::Language language, std::span<const LevelSize> levels);

/// A snippet unrolled for the basis, form and sizes of a map, beside its texture:
///     PREFIX_eval(uv, lod, wo, wi)     q of the texels around uv at level lod, clamped at 0
///     PREFIX_evalRaw(uv, lod, wo, wi)  the same, not clamped
///     PREFIX_shade(uv, lod, wo, env), PREFIX_shadeWorld(uv, lod, wo, t, b, n, light)
///                                      as gpu::shaderSource
///     PREFIX_level(dx, dy)             the level where uv changes by dx and dy from pixel to pixel
/// Texels are blended in both directions and between two levels (trilinear), in numbers in which
/// reflectance is linear: at the centre of a texel of a whole level the result is that texel's.
/// The forms low-rank and clusters read SharedNumbers too. Throws UsageError for a map that the
/// language cannot take, with the reason.
std::string mapShader(gpu::Language language, const MapSidecar& map,
                      const MapShaderOptions& options);

}  // namespace hshfit::inline material_maps::inline exports
