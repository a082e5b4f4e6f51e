#pragma once

#include "command.h"

#include <jobs/lighting/lighting_trade.h>

#include <string>
#include <vector>

namespace hshfit::cli {

/// Prints the trade of bytes, time and error of lighting for each BRDF, or with --json all of it.
void runTradeLighting(const std::vector<std::string>& specs,
                      const jobs::LightingTradeOptions& options, const Globals& globals);

}  // namespace hshfit::cli
