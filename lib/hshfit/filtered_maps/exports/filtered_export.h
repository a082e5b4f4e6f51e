#pragma once

#include <hshfit/files/file_set.h>
#include <hshfit/filtered_maps/exports/lobe_text.h>
#include <hshfit/filtered_maps/filtered_map.h>
#include <hshfit/material_maps/exports/map_export.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::inline filtered_maps::inline exports {

/// NAME.map.ktx2 and NAME.harmonics.ktx2, the bytes of the map's own textures, and NAME.shared.ktx2
/// of LobeNumbers. Throws InputError if a texture was changed meanwhile, and OutputError.
std::vector<MapTextureFile> writeFilteredKtx2(const FilteredMap& map, const std::string& name,
                                              FileSet& files);
/// The same for OSL as OpenEXR: NAME.map.exr, NAME.harmonics.exr and NAME.shared.exr.
std::vector<MapTextureFile> writeFilteredExr(const FilteredMap& map, const std::string& name,
                                             FileSet& files);

/// The sidecar, docs/schemas/gpu_filtered_map.schema.json: all that a reader of the textures needs.
std::string filteredExportText(const FilteredMap& map, Wrap wrap,
                               std::span<const MapTextureFile> textures,
                               std::span<const MapTest> tests);

/// One HTML page of `mapPage` with the map under a point light. Throws UsageError for a map of more
/// than `mostViewerBytes` or of more layers than WebGL 2 has.
std::string filteredViewerPage(const FilteredMap& map, const LobeText& lobe, Wrap wrap,
                               const std::string& title, std::span<const MapTest> tests);

}  // namespace hshfit::inline filtered_maps::inline exports
