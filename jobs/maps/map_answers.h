#pragma once

#include "filtered.h"
#include "svbrdf.h"

#include <nlohmann/json_fwd.hpp>

namespace hshfit::jobs {

/// The answer of `svbrdf`: the table of lobes, choices with bytes and errors, levels, rates, files
/// (docs/schemas/svbrdf.schema.json).
nlohmann::ordered_json svbrdfJson(const Svbrdf& done);

/// The answer for maps of filtered lobes (docs/schemas/filtered_map.schema.json).
nlohmann::ordered_json filteredMapJson(const FilteredMapAnswer& done);

}  // namespace hshfit::jobs
