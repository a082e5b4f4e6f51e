#pragma once

#include <hshfit/files/json_fields.h>
#include <hshfit/material_maps/texel_source.h>

#include <span>
#include <vector>

namespace hshfit::inline material_maps {

/// The sizes of levels as the sidecars of maps state them, the key "levels" of a texture.
nlohmann::ordered_json levelsJson(std::span<const LevelSize> levels);
/// The inverse. Throws InputError.
std::vector<LevelSize> readLevels(const JsonFields& texture);

}  // namespace hshfit::inline material_maps
