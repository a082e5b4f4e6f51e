#include "health.h"

#include "documents.h"

#include <hshfit/files/json_fields.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

Json censusJson(const brdfs::Census& census) {
    return {{"values", census.values},
            {"below_horizon", census.belowHorizon},
            {"invalid", census.invalid},
            {"negative", census.negative},
            {"nan", census.notANumber},
            {"infinite", census.infinite},
            {"least", finiteOrNull(census.least)},
            {"greatest", finiteOrNull(census.greatest)}};
}

Json axesJson(const std::vector<brdfs::Axis>& axes) {
    Json rows = Json::array();
    for (const auto& axis : axes) {
        rows.push_back({{"name", axis.name},
                        {"unit", axis.unit},
                        {"count", axis.count},
                        {"first", finiteOrNull(axis.first)},
                        {"last", finiteOrNull(axis.last)},
                        {"largest_gap", finiteOrNull(axis.largestGap)}});
    }
    return rows;
}

Json albedoJson(const std::vector<Health::Albedo>& integrals) {
    Json rows = Json::array();
    for (const auto& albedo : integrals) {
        Json row = directionJson(albedo.at);
        row["theta"] = std::round(row["theta"].get<double>());  // asked for in whole degrees
        row["phi"] = std::round(row["phi"].get<double>());
        row["values"] = albedo.values.empty() ? Json(nullptr) : Json(albedo.values);
        if (albedo.values.empty()) {
            row["reason"] =
                std::isinf(albedo.error) ? "more evaluations than are allowed" : "not finite";
        } else {
            row["error"] = finiteOrNull(albedo.error);
            if (!albedo.converged) row["reason"] = "did not converge";
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

Json exchangeJson(const Brdf& brdf, const Health::Exchange& exchange) {
    return {{"wi", directionJson(exchange.wi)},
            {"wo", directionJson(exchange.wo)},
            {"channel", brdf.channels().names()[exchange.channel]},
            {"value", exchange.value},
            {"exchanged", exchange.exchanged}};
}

Json reciprocityJson(const jobs::BrdfInfo& info) {
    const Health& health = *info.health;
    Json reciprocity = {{"defect", health.reciprocityDefect}};
    if (health.worstExchange)
        reciprocity["worst"] = exchangeJson(*info.brdf, *health.worstExchange);
    if (const auto& both = info.bothOrders) {
        reciprocity["samples"] = {{"pairs", both->pairs},
                                  {"defect", both->defect},
                                  {"largest_ratio", both->largestRatio}};
        if (both->worst) reciprocity["samples"]["worst"] = exchangeJson(*info.brdf, *both->worst);
    }
    return reciprocity;
}

Json healthJson(const jobs::BrdfInfo& info) {
    const Health& health = *info.health;
    Json repairs = Json::array();
    for (const auto& repair : info.repairs)
        repairs.push_back({{"name", repair.name}, {"reason", repair.reason}});
    return {{"pairs", health.pairs},
            {"coverage", health.coverage},
            {"values", health.values},
            {"negative", health.negative},
            {"not_finite", health.notFinite},
            {"reciprocity", reciprocityJson(info)},
            {"largest_reflectance", health.largestReflectance()},
            {"largest_albedo", health.largestAlbedo()},
            {"albedo_tolerance", health.albedoTolerance},
            {"suggested_repairs", repairs}};
}

/// Four digits: behind the point, or where a value is dark or huge, all of them.
std::string shareText(double value) {
    const bool plain = value == 0 || (std::abs(value) >= 0.01 && std::abs(value) < 1e4);
    return plain ? fmt::format("{:.4f}", value) : fmt::format("{:.4g}", value);
}

std::string albedoText(const Json& row) {
    if (row["values"].is_null()) return row["reason"].get<std::string>();
    std::vector<double> shown = row["values"];
    const bool many = shown.size() > 8;
    if (many) shown.resize(8);
    std::string text;
    for (const double value : shown) text += (text.empty() ? "" : " ") + shareText(value);
    if (many) text += " …";
    if (!row.contains("reason")) return text;
    return row["error"].is_null() ? text + " (one sum, of unknown error)"
                                  : fmt::format("{} +- {:.2g}", text, row["error"].get<double>());
}

std::string integralsText(const char* what, const Json& rows) {
    std::string text;
    for (const Json& row : rows) {
        std::string name = fmt::format("{} at {:g}", what, row["theta"].get<double>());
        if (row["phi"] != 0.0) name += fmt::format(",{:g}", row["phi"].get<double>());
        text += factLine(name + " degrees", albedoText(row));
    }
    return text;
}

std::string censusText(const Json& census) {
    std::string text = factLine("stored values", jsonText(census["values"]));
    for (const auto& [key, value] : census.items()) {
        if (key == "values" || value == 0) continue;
        text += factLine("  " + key, jsonText(value));
    }
    return text;
}

std::string axisText(const Json& axis) {
    const auto number = [&](const char* key) {
        return axis[key].is_null() ? "?" : fmt::format("{:.6g}", axis[key].get<double>());
    };
    return fmt::format("{} from {} to {} {}, gaps up to {}", axis["count"].get<std::size_t>(),
                       number("first"), number("last"), axis["unit"].get<std::string>(),
                       number("largest_gap"));
}

std::string bothOrdersText(const Json& samples) {
    return factLine("  of the samples", fmt::format("{:.2g} over {} pairs measured in both orders, "
                                                    "which differ by up to {:.3g} times",
                                                    samples["defect"].get<double>(),
                                                    samples["pairs"].get<std::size_t>(),
                                                    samples["largest_ratio"].get<double>()));
}

}  // namespace

std::string factLine(std::string name, const std::string& value) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return fmt::format("  {:<28} {}\n", name, value);
}

void describeHealth(const jobs::BrdfInfo& info, Json& document) {
    if (info.census) {
        document["census"] = censusJson(*info.census);
        document["axes"] = axesJson(info.axes);
    }
    if (!info.health) return;
    document["reflectance"] = albedoJson(info.health->reflectances);
    document["albedo"] = albedoJson(info.health->albedos);
    document["health"] = healthJson(info);
}

std::string healthText(const Json& document) {
    std::string text;
    if (document.contains("census")) text += censusText(document["census"]);
    for (const Json& axis : document.value("axes", Json::array())) {
        text += factLine("sampled " + axis["name"].get<std::string>(), axisText(axis));
    }
    if (!document.contains("health")) return text;  // no channel is a reflectance
    // Both are the same numbers for a reciprocal BRDF.
    const bool both = document["reflectance"] != document["albedo"];
    // A transmission lets light of one direction through, and shows radiance under uniform light.
    const bool through = document.contains("side");
    const std::string share = through ? "transmittance" : "reflectance",
                      albedo = through ? "radiance" : "albedo";
    if (both) text += integralsText(share.c_str(), document["reflectance"]);
    text += integralsText(albedo.c_str(), document["albedo"]);
    const Json& health = document["health"];
    text += factLine("measured directions",
                     fmt::format("{:.1f} % of the pairs", 100 * health["coverage"].get<double>()));
    text += factLine("values below 0", fmt::format("{} of {} sampled", jsonText(health["negative"]),
                                                   jsonText(health["values"])));
    if (health["not_finite"] != 0)
        text += factLine("values not finite", jsonText(health["not_finite"]));
    const Json& reciprocity = health["reciprocity"];
    std::string defect = fmt::format("{:.2g}", reciprocity["defect"].get<double>());
    if (reciprocity.contains("worst") && reciprocity["defect"] > 1e-9) {
        const Json& worst = reciprocity["worst"];
        defect +=
            fmt::format(" (most: {:.4g} and {:.4g} in {})", worst["value"].get<double>(),
                        worst["exchanged"].get<double>(), worst["channel"].get<std::string>());
    }
    if (!through) text += factLine("reciprocity defect", defect);
    if (reciprocity.contains("samples")) text += bothOrdersText(reciprocity["samples"]);
    if (both) text += factLine("largest " + share, shareText(health["largest_reflectance"]));
    text += factLine("largest " + albedo, shareText(health["largest_albedo"]));
    for (const Json& repair : health["suggested_repairs"]) {
        text +=
            factLine("suggested repair", fmt::format("{} ({})", repair["name"].get<std::string>(),
                                                     repair["reason"].get<std::string>()));
    }
    return text;
}

}  // namespace hshfit::cli
