#pragma once

// `info` of a light: what it is and a report on its health.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hshfit::cli {

/// The answer for a light specification; invalid pixels are counted, not refused.
nlohmann::ordered_json describeLight(const std::string& spec);

std::string lightText(const nlohmann::ordered_json& document);

}  // namespace hshfit::cli
