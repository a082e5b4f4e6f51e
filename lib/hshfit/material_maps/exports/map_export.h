#pragma once

#include <hshfit/files/file_set.h>
#include <hshfit/material_maps/exports/map_sampler.h>
#include <hshfit/material_maps/exports/shared_numbers.h>
#include <hshfit/material_maps/material_map.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline material_maps::inline exports {

/// A texture of an export: "map", the texels, or "shared", what they share.
struct MapTextureFile {
    std::string role, container, path;
    std::uint64_t bytes = 0;
    std::string sha256;
};

/// NAME.map.ktx2, the bytes of the map's own texture, and for the forms low-rank and clusters
/// NAME.shared.ktx2. Throws InputError if the texture was changed meanwhile, and OutputError.
std::vector<MapTextureFile> writeMapKtx2(const MaterialMap& map, const std::string& name,
                                         FileSet& files);
/// The same for OSL as OpenEXR files of tiles with levels, a part for each layer: NAME.map.exr and
/// NAME.shared.exr, float16 or float32. Levels below the map's last, which OpenEXR wants, repeat
/// it.
std::vector<MapTextureFile> writeMapExr(const MaterialMap& map, const std::string& name,
                                        FileSet& files);

/// The sidecar, docs/schemas/gpu_map.schema.json: all that a reader of the textures needs.
std::string mapExportText(const MaterialMap& map, Wrap wrap,
                          std::span<const MapTextureFile> textures, std::span<const MapTest> tests);
/// NAME_test.json: the tests alone, docs/schemas/gpu_map_test.schema.json.
std::string mapTestText(const MapSidecar& map, std::span<const MapTest> tests);

}  // namespace hshfit::inline material_maps::inline exports
