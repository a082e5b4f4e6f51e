#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::cli {

/// The keys "uncertainty" and "influence" of a fit as text, each line after two blanks; empty if
/// the fit has none.
std::string uncertaintyText(const nlohmann::ordered_json& fit);

}  // namespace hshfit::cli
