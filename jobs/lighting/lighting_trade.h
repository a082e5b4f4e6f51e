#pragma once

#include "lighting_errors.h"

#include <jobs/common/option_row.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// A model of lighting at one setting under one light.
struct LightingTrade {
    std::string settings;  ///< "order 5", "faces up to 32", "64 tiles", "2 lobes"
    LightingError error;
    bool front = false;  ///< no other one has fewer bytes, less time and less error
};

struct LightingTradeOptions {
    std::string models = "all";  ///< selectLightingModels
    LightingErrorOptions errors = {};
    std::vector<int> orders = {3, 5, 8};               ///< of coefficients
    std::vector<std::size_t> faces = {16, 32, 128};    ///< of split sums, at most
    std::vector<std::size_t> tiles = {16, 64, 256};    ///< of transformed cosines
    std::vector<std::size_t> lobes = {1, 2, 3, 4, 6};  ///< of prefiltered environments
};
OptionRows<LightingTradeOptions> lightingTradeOptions();

/// Every model at every setting under every light, by light: bytes of table and light, time of a
/// point, relative L2 against direct integration on a sphere. Settings that make the same table
/// and light as the one before are left out. Errors as lightingErrors.
std::vector<LightingTrade> tradeLighting(const Brdf& brdf, const LightingTradeOptions& options,
                                         const Listener& listener = {});

/// The least of the trades under `light` whose error is at most `budget`: by bytes, or by time.
/// None where there is none.
std::optional<LightingTrade> chooseLighting(std::span<const LightingTrade> trades,
                                            const std::string& light, double budget, bool byTime);

/// Rows of lightingErrorsJson with `settings` and `front`.
nlohmann::ordered_json lightingTradesJson(std::span<const LightingTrade> trades);

}  // namespace hshfit::jobs
