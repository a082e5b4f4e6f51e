#pragma once

#include <hshfit/files/json_fields.h>
#include <hshfit/material_maps/exports/map_export.h>
#include <hshfit/material_maps/level_json.h>

#include <span>

namespace hshfit::inline material_maps::inline exports {

// Parts of the sidecars of maps.

nlohmann::ordered_json filesJson(std::span<const MapTextureFile> files);
nlohmann::ordered_json testsJson(std::span<const MapTest> tests);

}  // namespace hshfit::inline material_maps::inline exports
