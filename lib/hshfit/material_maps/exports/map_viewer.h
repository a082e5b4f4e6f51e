#pragma once

#include <hshfit/gpu/viewer_light.h>
#include <hshfit/material_maps/exports/map_sampler.h>
#include <hshfit/material_maps/material_map.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::inline material_maps::inline exports {

/// The most bytes of texels that a page holds; base64 makes a third more of them.
constexpr std::size_t mostViewerBytes = std::size_t{64} << 20;

struct MapViewerInput {
    const MaterialMap& map;
    Wrap wrap = Wrap::clamp;
    std::string title = {};
    std::vector<gpu::ViewerLight> lights = {};  ///< of `order` bands, at least one
    int order = 5;
    std::span<const MapTest> tests = {};  ///< that the page can check itself by
};

/// One self-contained HTML page (WebGL 2, no network): the map on a plane or a sphere under a point
/// light and an environment, by the shader of `mapShader`, with the level that each pixel takes.
/// Throws UsageError for a map of more than `mostViewerBytes`, of more layers than WebGL 2 has, or
/// without a light.
std::string mapViewerPage(const MapViewerInput& input);

}  // namespace hshfit::inline material_maps::inline exports
