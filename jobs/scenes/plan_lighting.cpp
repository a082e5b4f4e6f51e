#include "plan_lighting.h"

#include <jobs/source/source.h>

#include <hshfit/error.h>

#include <nlohmann/json.hpp>

namespace hshfit::jobs {

std::vector<PlannedLighting> planLighting(const plan::Scene& scene, const std::string& models,
                                          bool byTime, const Listener& listener) {
    selectLightingModels(models);
    LightingTradeOptions options{.models = models};
    options.lobes = {1, 2, 3};  // fits of more take too long for scenes of many materials
    options.errors.given = {{scene.file, scene.lights}};
    std::vector<PlannedLighting> planned;
    for (const plan::Material& material : scene.materials) {
        PlannedLighting row{.material = material.name, .budget = material.budget.error};
        try {
            row.trades = tradeLighting(*openBrdf(material.brdf, true), options, listener);
            row.choice = chooseLighting(row.trades, scene.file, row.budget, byTime);
        } catch (const Error& error) {
            row.refused = error.what();
        }
        planned.push_back(std::move(row));
    }
    return planned;
}

nlohmann::ordered_json plannedLightingJson(std::span<const PlannedLighting> planned) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const PlannedLighting& row : planned) {
        nlohmann::ordered_json entry = {{"material", row.material}, {"budget", row.budget}};
        if (!row.refused.empty()) entry["refused"] = row.refused;
        entry["choice"] =
            row.choice ? lightingTradesJson({&*row.choice, 1}).front() : nlohmann::ordered_json();
        entry["trades"] = lightingTradesJson(row.trades);
        rows.push_back(entry);
    }
    return rows;
}

}  // namespace hshfit::jobs
