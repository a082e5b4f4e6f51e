#pragma once

// The answer of `info` on the health of a BRDF.

#include <jobs/studies/info.h>

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::cli {

/// The members "reflectance" (over wo, by wi), "albedo" (over wi, by wo), "health", and for a
/// measured BRDF "census" and "axes".
void describeHealth(const jobs::BrdfInfo& info, nlohmann::ordered_json& document);

/// The members of describeHealth as indented lines.
std::string healthText(const nlohmann::ordered_json& document);

/// A name in two columns: "  coverage      …".
std::string factLine(std::string name, const std::string& value);

}  // namespace hshfit::cli
