#pragma once

#include <brdfs/fit/fit_json.h>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::brdfs {

/// The key "uncertainty" of a fit: chi-square, errors by each route, covariance and correlations.
nlohmann::ordered_json uncertaintyJson(const FitReport& report);

/// The key "influence": the values with the largest Cook's distances, and outliers, at most
/// `mostListed` of each.
inline constexpr std::size_t mostListed = 20;
nlohmann::ordered_json influenceJson(const FitSamples& samples, const Uncertainty& uncertainty);

}  // namespace hshfit::brdfs
