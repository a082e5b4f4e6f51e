#pragma once

// `info` of a light: what it is and a report on its health.

#include <jobs/studies/info.h>

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::cli {

nlohmann::ordered_json lightAnswer(const std::string& spec, const jobs::LightInfo& info);

/// The answer as indented lines.
std::string lightText(const nlohmann::ordered_json& document);

}  // namespace hshfit::cli
