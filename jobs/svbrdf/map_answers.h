#pragma once

#include "filtered.h"
#include "svbrdf.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::jobs {

/// The answer of `svbrdf`: the table of lobes, choices with bytes and errors, levels, rates, files
/// (docs/schemas/svbrdf.schema.json).
nlohmann::ordered_json svbrdfJson(const Svbrdf& done);

/// The same of maps of filtered lobes (docs/schemas/filtered_map.schema.json).
nlohmann::ordered_json filteredMapJson(const FilteredMapAnswer& done);

/// The call that captures more of the poorest lobe; empty if none is known.
std::string betterCall(const Svbrdf& done);

}  // namespace hshfit::jobs
