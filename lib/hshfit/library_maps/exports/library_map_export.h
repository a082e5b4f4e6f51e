#pragma once

#include <hshfit/library_maps/exports/library_map_shader.h>
#include <hshfit/material_maps/exports/map_export.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::inline library_maps::inline exports {

/// NAME.map.ktx2, the bytes of the map's own texture, and NAME.functions.ktx2 with the table.
/// Throws InputError if the texture was changed meanwhile, and OutputError.
std::vector<MapTextureFile> writeLibraryMapKtx2(const LibraryMap& map,
                                                const MapFunctions& functions,
                                                const std::string& name, FileSet& files);

/// NAME.map.exr and NAME.functions.exr for OSL, a part for each layer, as writeMapExr.
std::vector<MapTextureFile> writeLibraryMapExr(const LibraryMap& map, const MapFunctions& functions,
                                               const std::string& name, FileSet& files);

/// NAME.library, which has the basis.
MapTextureFile writeMapLibrary(const LibraryMap& map, const std::string& name, FileSet& files);

/// The sidecar, docs/schemas/gpu_library_map.schema.json.
std::string libraryMapExportText(const LibraryMap& map, const MapFunctions& functions, Wrap wrap,
                                 std::span<const MapTextureFile> textures,
                                 std::span<const MapTest> tests);

/// The page of `mapPage`.
std::string libraryMapViewerPage(const LibraryMap& map, const MapFunctions& functions, Wrap wrap,
                                 const std::string& title, std::span<const MapTest> tests);

}  // namespace hshfit::inline library_maps::inline exports
