#include <hshfit/files/json_fields.h>
#include <hshfit/pages/internal/comparison_files.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/version.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::inline pages {
namespace {

using Json = nlohmann::ordered_json;

Json directionJson(const Direction& d) {
    return {{"theta", degrees(polarAngle(d))}, {"phi", degrees(azimuth(d))}};
}

Json sideJson(const ComparedBrdf& side) {
    return {{"brdf", side.name},
            {"channels", side.channels.names()},
            {"isotropic", side.laws.isotropic},
            {"albedo_error", side.albedoError},
            {"not_finite", side.notFinite}};
}

/// The form of `hshfit compare --json`.
Json metricsJson(const std::vector<MetricValue>& metrics) {
    Json rows = Json::array();
    for (const MetricValue& result : metrics) {
        Json row = {{"name", result.metric->name},
                    {"value", result.value ? Json(*result.value) : Json(nullptr)}};
        if (result.value) row["error"] = result.error;
        if (!result.reason.empty()) row["reason"] = result.reason;
        if (result.wi) row["at"]["wi"] = directionJson(*result.wi);
        if (result.wo) row["at"]["wo"] = directionJson(*result.wo);
        rows.push_back(row);
    }
    return rows;
}

Json residualJson(const Comparison& comparison) {
    const ResidualShares shares = residualShares(comparison);
    Json json = {{"measured_cells", shares.cells},
                 {"unmeasured_cells", shares.unmeasured},
                 {"without_ratio", shares.noRatio}};
    const bool any = shares.cells > shares.noRatio;
    json["median_ratio"] = any ? Json(std::pow(10, shares.median)) : Json(nullptr);
    json["ratio_of_98_percent"] = any ? Json(std::pow(10, shares.most)) : Json(nullptr);
    json["within_10_percent"] = any ? Json(shares.withinTenth) : Json(nullptr);
    json["within_factor_2"] = any ? Json(shares.withinTwofold) : Json(nullptr);
    return json;
}

Json spheresJson(const Comparison& comparison) {
    Json lights = Json::array();
    for (const SphereLight& light : comparison.rig.lights) {
        Json json = directionJson(light.towards);
        json["strength"] = light.strength;
        lights.push_back(json);
    }
    return {
        {"size", comparison.referenceSphere.size},
        {"order", {"reference", "approximation", "difference"}},
        {"lights", lights},
        {"dome", comparison.rig.dome},
        {"exposure_stops", comparison.stops},
        {"amplification", comparison.amplification},
        {"reference_mean_square", meanSquare(comparison.referenceSphere)},
        {"difference_mean_square", meanSquare(comparison.difference)},
        {"colours", {comparison.referenceSphere.colours, comparison.approximationSphere.colours}}};
}

}  // namespace

std::string comparisonJson(const Comparison& comparison) {
    Json azimuths = Json::array(), figures = Json::array(), drawn = Json::array();
    for (const ResidualMap& map : comparison.residuals) azimuths.push_back(map.azimuth);
    for (const ComparisonFigure& figure : figuresOf(comparison)) figures.push_back(figure.file);
    const auto names = comparison.channels.names();
    for (const std::size_t c : comparison.drawn) drawn.push_back(names[c]);
    Json document = {{"format", "hshfit-comparison"},
                     {"version", 1},
                     {"reference", sideJson(comparison.reference)},
                     {"approximation", sideJson(comparison.approximation)},
                     {"outgoing", comparison.outgoing.spec()},
                     {"drawn", drawn},
                     {"azimuths", azimuths},
                     {"metrics", metricsJson(comparison.metrics)},
                     {"residual", residualJson(comparison)},
                     {"spheres", spheresJson(comparison)},
                     {"figures", figures},
                     {"generator", std::string("hshfit ") + version}};
    if (comparison.picture) document["picture"] = pictureErrorJson(*comparison.picture);
    return jsonText(document, 2) + "\n";
}

}  // namespace hshfit::inline pages
