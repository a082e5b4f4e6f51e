#include <brdfs/fit/budget_json.h>

#include <hshfit/files/json_fields.h>

#include <nlohmann/json.hpp>

namespace hshfit::brdfs {
namespace {

using Json = nlohmann::ordered_json;

Json rowJson(const BudgetRow& row) {
    Json json = {{"name", row.name},
                 {"type", std::string(1, row.type)},
                 {"distribution", row.distribution},
                 {"standard_uncertainty", row.standard}};
    if (!row.unit.empty()) json["unit"] = row.unit;
    json["sensitivity"] = row.sensitivity;
    json["contribution"] = row.contribution;
    json["share"] = row.share;
    json["degrees_of_freedom"] = finiteOrNull(row.degrees);
    return json;
}

}  // namespace

Json budgetJson(const Budget& budget) {
    Json parameters = Json::array();
    for (const ParameterBudget& own : budget.parameters) {
        Json json = {{"name", own.name}};
        if (!own.channel.empty()) json["channel"] = own.channel;
        json["value"] = own.value;
        json["contributions"] = Json::array();
        for (const BudgetRow& row : own.rows) json["contributions"].push_back(rowJson(row));
        json["combined_standard_uncertainty"] = own.combined;
        json["effective_degrees_of_freedom"] = finiteOrNull(own.degrees);
        json["coverage_factor"] = own.coverage;
        json["expanded_uncertainty"] = own.expanded;
        parameters.push_back(std::move(json));
    }
    return {{"coverage_probability", Budget::probability}, {"parameters", parameters}};
}

}  // namespace hshfit::brdfs
