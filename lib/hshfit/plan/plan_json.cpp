#include <hshfit/choice/row_json.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/pages/pair_summary_json.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/plan/plan_files.h>
#include <hshfit/version.h>

#include <nlohmann/json.hpp>

namespace hshfit::plan {
namespace {

using Json = nlohmann::ordered_json;

Json rangeJson(double from, double to) {
    return {degrees(from), degrees(to)};
}

Json choiceJson(const Choice& choice, const std::string& file) {
    Json json = {{"brdf", choice.spec},
                 {"options", optionsOf(choice.form)},
                 {"command", commandOf(choice, file)},
                 {"bytes", choice.bytes},
                 {"error", finiteOrNull(choice.error)}};
    if (choice.flip) json["flip"] = overLightsJson(*choice.flip);
    if (choice.nanoseconds) json["nanoseconds"] = *choice.nanoseconds;
    return json;
}

Json acceptedJson(const Accepted& accepted, const std::string& file) {
    Json json = choiceJson(accepted.choice, file);
    json["file"] = file;
    json["entropy_bytes"] = accepted.representation.entropyBytes();
    json["times_smaller"] =
        static_cast<double>(baselineBytes) / static_cast<double>(accepted.choice.bytes);
    json["verified_error"] = accepted.verified;
    json["raised"] = accepted.raised;
    if (accepted.cost) json["cost"] = choice::costJson(*accepted.cost);
    json["picture"] = pictureErrorJson(accepted.picture);
    json["pairs"] = pairSummaryJson(accepted.pairs);
    Json rows = Json::array();
    for (std::size_t k = 0; k < accepted.thetas.size(); ++k) {
        rows.push_back(
            {{"theta", degrees(accepted.thetas[k])}, {"error", finiteOrNull(accepted.errors[k])}});
    }
    json["error_by_elevation"] = rows;
    return json;
}

Json budgetJson(const Budget& budget) {
    Json json = {{"metric", metricName(budget.metric)}, {"error", budget.error}};
    if (budget.flip) json["flip"] = *budget.flip;
    return json;
}

Json formulasJson(const std::vector<PlannedFormula>& formulas) {
    Json list = Json::array();
    for (const PlannedFormula& formula : formulas) {
        Json row = choice::rowJson(formula.row);
        row["error"] = finiteOrNull(formula.error);
        row["verified_error"] = finiteOrNull(formula.verified);
        row["within"] = formula.within;
        if (formula.row.cost) row["cost"] = choice::costJson(*formula.row.cost);
        list.push_back(row);
    }
    return list;
}

Json seenJson(const SeenMaterial& seen) {
    Json orientations = Json::array();
    for (std::size_t k = 0; k < seen.orientations.size(); ++k) {
        const Orientation& each = seen.orientations[k];
        orientations.push_back({{"theta", degrees(each.theta)},
                                {"phi", degrees(each.phi)},
                                {"turn", degrees(each.turn)},
                                {"share", seen.shares[k]}});
    }
    Json json = {{"rays", seen.rays},
                 {"hits", seen.hits},
                 {"share", seen.share()},
                 {"orientations", orientations},
                 {"spread", degrees(seen.spread)}};
    if (seen.hits > 0) {
        json["views"] = {{"theta", rangeJson(seen.views.thetaMin, seen.views.thetaMax)},
                         {"phi", rangeJson(seen.views.phiMin, seen.views.phiMax)}};
    }
    return json;
}

Json materialJson(const MaterialPlan& plan) {
    const Material& material = plan.material;
    const std::string file = material.name + ".json";
    Json json = {{"name", material.name},
                 {"brdf", material.brdf},
                 {"budget", budgetJson(material.budget)},
                 {"orientations", material.orientations.size()},
                 {"planned", plan.accepted.has_value()}};
    if (plan.accepted) json["choice"] = acceptedJson(*plan.accepted, file);
    json["cheaper"] = Json::array();
    for (const Choice& each : plan.cheaper) json["cheaper"].push_back(choiceJson(each, file));
    if (plan.dearer) json["dearer"] = choiceJson(*plan.dearer, file);
    json["formulas"] = formulasJson(plan.formulas);
    if (!plan.accepted) {
        json["refused"] = plan.refused;
        json["instead"] = plan.instead;
    }
    if (plan.seen) json["seen"] = seenJson(*plan.seen);
    json["rules"] = plan.rules;
    json["light"] = {{"band_power", plan.lightPower},
                     {"samples", plan.lightSamples},
                     {"sampling_error", finiteOrNull(plan.referenceError)}};
    json["views"] = plan.views;
    json["forms"] = {{"listed", plan.rungs}, {"tried", plan.tried}, {"cut", plan.cut}};
    return json;
}

}  // namespace

std::string planJson(const Plan& plan) {
    const Scene& scene = plan.scene;
    Json json = {{"format", "hshfit-plan"},
                 {"version", 1},
                 {"generator", std::string("hshfit ") + version},
                 {"scene", scene.file},
                 {"views",
                  {{"theta", rangeJson(scene.views.thetaMin, scene.views.thetaMax)},
                   {"phi", rangeJson(scene.views.phiMin, scene.views.phiMax)},
                   {"tangent", scene.views.anyTangent ? "any" : "fixed"}}},
                 {"limits", {{"bytes", scene.limits.bytes}}},
                 {"baseline_bytes", baselineBytes}};
    if (scene.limits.nanoseconds) json["limits"]["nanoseconds"] = *scene.limits.nanoseconds;
    if (plan.costs) json["costs"] = choice::scaleJson(*plan.costs);
    json["materials"] = Json::array();
    for (const MaterialPlan& each : plan.materials) json["materials"].push_back(materialJson(each));
    return jsonText(json, 2) + '\n';
}

}  // namespace hshfit::plan
