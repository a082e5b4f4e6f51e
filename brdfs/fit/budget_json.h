#pragma once

#include <brdfs/fit/budget.h>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::brdfs {

/// The budget in the report of a fit (docs/schemas/fit.schema.json).
nlohmann::ordered_json budgetJson(const Budget& budget);

}  // namespace hshfit::brdfs
