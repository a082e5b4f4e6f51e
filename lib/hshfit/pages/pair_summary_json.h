#pragma once

#include <hshfit/accuracy/pair_errors.h>

#include <string>

namespace hshfit::inline pages {

/// The object "pairs" of several answers, as text; directions in degrees, null for what is no
/// number.
std::string pairSummaryJson(const PairSummary& summary);

}  // namespace hshfit::inline pages
