#pragma once

#include <hshfit/accuracy/pair_errors.h>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::inline pages {

/// The object "pairs" of several answers; directions in degrees, null for infinity and NaN.
nlohmann::ordered_json pairSummaryJson(const PairSummary& summary);

}  // namespace hshfit::inline pages
