#pragma once

#include <jobs/lighting/lighting_trade.h>

#include <hshfit/plan/plan.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct PlanLightingOptions {
    std::string models = {};  ///< selectLightingModels; empty: none
};
OptionRows<PlanLightingOptions> planLightingOptions();

/// The way to light a material of a scene in real time.
struct PlannedLighting {
    std::string material;
    double budget = 0;                         ///< of the relative L2 error of a sphere's picture
    std::optional<LightingTrade> choice = {};  ///< none: no model is within the budget
    std::vector<LightingTrade> trades = {};    ///< what it was chosen from
    std::string refused = {};                  ///< reason why nothing could be tried
};

/// For each material of a scene, the least model of lighting (by bytes, or by time) whose picture
/// of a sphere under the scene's lights is within the number of the material's budget, whatever its
/// metric. A material that cannot be opened has a reason.
/// Throws UsageError for unknown models.
std::vector<PlannedLighting> planLighting(const plan::Scene& scene, const std::string& models,
                                          bool byTime, const Listener& listener = {});

nlohmann::ordered_json plannedLightingJson(std::span<const PlannedLighting> planned);

}  // namespace hshfit::jobs
