#pragma once

#include <hshfit/brdf/directions.h>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::jobs {

/// {"theta": degrees, "phi": degrees}
nlohmann::ordered_json directionJson(const Direction& d);

}  // namespace hshfit::jobs
