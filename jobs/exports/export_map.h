#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>
#include "exportable_map.h"

#include <string>
#include <vector>

namespace hshfit::jobs {

struct MapExportOptions {
    /// gpu::selectTargets: ktx2, exr-parts, the languages and the viewer.
    std::string targets = "ktx2,glsl-es";
    std::string name = {};       ///< of the files; empty: the map file's name
    std::string prefix = "hsh";  ///< of every name in a shader
    int environmentOrder = 5;    ///< of the light that shaders' shade() takes; 0: no shade()
    std::string wrap = "clamp";  ///< parseWrap
    /// Specifications of lights that the viewer offers; empty: studio.
    std::vector<std::string> lights = {};
    bool force = false;  ///< replace existing files
};
/// The options that maps alone have.
OptionRows<MapExportOptions> mapExportOptions();

/// A shader or the viewer.
struct ExportedMapText {
    std::string role, target, path;
};

struct ExportedMap {
    std::string name;
    ExportableMap::Facts map;
    std::string sidecar, test;  ///< names of files in the folder, as below
    std::vector<MapTextureFile> textures;
    std::vector<ExportedMapText> texts;
    std::vector<gpu::ViewerLight> lights;  ///< of the viewer
};

/// Exports a map of `svbrdf` to `folder` as textures, shaders and a viewer: all files or none. With
/// the targets "all", those that cannot hold the map are left out, with a note. Throws UsageError,
/// InputError and OutputError.
ExportedMap exportMap(const std::string& map, const std::string& folder,
                      const MapExportOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
