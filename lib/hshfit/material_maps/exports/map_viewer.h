#pragma once

#include <hshfit/gpu/viewer_light.h>
#include <hshfit/material_maps/exports/map_export.h>
#include <hshfit/material_maps/exports/map_sampler.h>
#include <hshfit/material_maps/material_map.h>

#include <span>
#include <string>
#include <string_view>
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

/// A map of any kind as the page takes it.
struct MapPage {
    std::string form, title, summary;
    StoredLevels map = {}, harmonics = {};  ///< the latter without levels: none
    const gpu::Texels* shared = nullptr;
    Channels channels = {};
    bool cosine = false;  ///< whether values are f cos(theta_i)
    Wrap wrap = Wrap::clamp;
    std::vector<gpu::ViewerLight> lights = {};  ///< none: the snippet has no `shadeWorld`
    int order = 5;                              ///< of their bands
    std::span<const MapTest> tests = {};
    std::string snippet = {};         ///< in GLSL ES, with the prefix hsh
    std::string raw = "hsh_evalRaw";  ///< the function that tests are of
};
/// The page. Throws UsageError as `mapViewerPage`, naming `smaller` as forms with fewer texels.
std::string mapPage(const MapPage& page, std::string_view smaller);

}  // namespace hshfit::inline material_maps::inline exports
