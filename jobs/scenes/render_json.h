#pragma once

#include "render.h"
#include "spheres.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::jobs {

/// The answer of `render`: the sheet, its lights and exposure, and each of its pictures with its
/// errors (docs/schemas/render.schema.json).
nlohmann::ordered_json renderJson(const Rendered& rendered, const RenderOptions& options,
                                  const std::string& output);
/// The answer of `render` for spheres under point lights.
nlohmann::ordered_json renderJson(const SphereSheet& sheet, const SphereSheetOptions& options,
                                  const std::string& output);

}  // namespace hshfit::jobs
