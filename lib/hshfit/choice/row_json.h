#pragma once

#include <hshfit/choice/rows.h>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::choice {

/// A row without its cost and without a renderer's reasons
/// (docs/schemas/material_row.schema.json).
nlohmann::ordered_json rowJson(const Row& row);
nlohmann::ordered_json costJson(const gpu::ShaderCost& cost);
nlohmann::ordered_json scaleJson(const CostScale& scale);

}  // namespace hshfit::choice
