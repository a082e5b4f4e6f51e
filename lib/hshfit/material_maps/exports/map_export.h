#pragma once

#include <hshfit/files/file_set.h>
#include <hshfit/material_maps/exports/map_sampler.h>
#include <hshfit/material_maps/exports/shared_numbers.h>
#include <hshfit/material_maps/material_map.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline material_maps::inline exports {

/// A texture of an export: "map", the texels, or "shared", what they share.
struct MapTextureFile {
    std::string role, container, path;
    std::uint64_t bytes = 0;
    std::string sha256;
};

/// The bytes of a KTX 2.0 file, as they are, under a name of the export.
MapTextureFile writeTextureKtx2(std::string_view role, const std::string& name,
                                std::span<const std::byte> bytes, FileSet& files);
/// Numbers of one layer and level, as KTX 2.0 and as OpenEXR.
MapTextureFile writeSharedKtx2(const std::string& name, const gpu::Texels& texels, FileSet& files);
MapTextureFile writeSharedExr(const std::string& name, const gpu::Texels& texels, FileSet& files);

/// Levels of texels of four numbers, as a LevelFile has them.
struct StoredLevels {
    std::span<const LevelSize> levels;
    std::size_t layers = 1;
    gpu::Number number = gpu::Number::float16;
    std::function<std::span<const std::byte>(std::size_t level)> bytes = {};
};
/// OpenEXR of tiles with levels, a part for each layer, float16 or float32. Levels below the last,
/// which OpenEXR wants, repeat it.
MapTextureFile writeTextureExr(std::string_view role, const std::string& name,
                               const StoredLevels& stored, FileSet& files);

/// NAME.map.ktx2, the bytes of the map's own texture, and for the forms low-rank and clusters
/// NAME.shared.ktx2. Throws InputError if the texture was changed meanwhile, and OutputError.
std::vector<MapTextureFile> writeMapKtx2(const MaterialMap& map, const std::string& name,
                                         FileSet& files);
/// The same for OSL: NAME.map.exr and NAME.shared.exr.
std::vector<MapTextureFile> writeMapExr(const MaterialMap& map, const std::string& name,
                                        FileSet& files);

/// The sidecar, docs/schemas/gpu_map.schema.json: all that a reader of the textures needs.
std::string mapExportText(const MaterialMap& map, Wrap wrap,
                          std::span<const MapTextureFile> textures, std::span<const MapTest> tests);
/// NAME_test.json: the tests alone, docs/schemas/gpu_map_test.schema.json. `value` says what the
/// values are.
std::string mapTestText(const Channels& channels, std::string_view value,
                        std::span<const MapTest> tests);
std::string mapTestText(const MapSidecar& map, std::span<const MapTest> tests);

}  // namespace hshfit::inline material_maps::inline exports
