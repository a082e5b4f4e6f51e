#include <hshfit/pages/pair_summary_json.h>

#include <hshfit/brdf/directions.h>
#include <hshfit/files/json_fields.h>

#include <nlohmann/json.hpp>

#include <string>

namespace hshfit::inline pages {

nlohmann::ordered_json pairSummaryJson(const PairSummary& summary) {
    using Json = nlohmann::ordered_json;
    const auto valueJson = [](const PairSummary::Value& v) -> Json {
        return {{"value", finiteOrNull(v.value)}, {"error", finiteOrNull(v.error)}};
    };
    const auto place = [](const Direction& d) -> Json {
        return {{"theta", degrees(polarAngle(d))}, {"phi", degrees(azimuth(d))}};
    };
    Json json = {{"count", summary.pairs}, {"mean_log", valueJson(summary.meanLog)}};
    for (std::size_t z = 0; z < zoneCount; ++z) {
        json[std::string(zoneNames[z])] = valueJson(summary.zones[z]);
    }
    json["relative_l2"] = valueJson(summary.relativeL2);
    json["energy_left"] = valueJson(summary.energyLeft);
    json["maximum"] = {{"value", finiteOrNull(summary.maximum)},
                       {"wi", place(summary.at.wi)},
                       {"wo", place(summary.at.wo)}};
    json["albedo"] = valueJson(summary.albedo);
    json["albedo"]["of"] = finiteOrNull(summary.albedoThere);
    json["albedo"]["theta_o"] = {degrees(summary.albedoFrom), degrees(summary.albedoTo)};
    return json;
}

}  // namespace hshfit::inline pages
