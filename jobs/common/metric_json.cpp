#include "metric_json.h"

#include "direction_json.h"

#include <nlohmann/json.hpp>

namespace hshfit::jobs {

using Json = nlohmann::ordered_json;

Json metricJson(const MetricValue& result) {
    Json json = {{"name", result.metric->name},
                 {"value", result.value ? Json(*result.value) : Json(nullptr)}};
    if (result.value) json["error"] = result.error;
    if (!result.reason.empty()) json["reason"] = result.reason;
    if (result.wo) {
        Json at;
        if (result.wi) at["wi"] = directionJson(*result.wi);
        at["wo"] = directionJson(*result.wo);
        json["at"] = at;
    }
    return json;
}

Json metricValuesJson(const std::vector<MetricValue>& results) {
    Json rows = Json::array();
    for (const MetricValue& result : results) rows.push_back(metricJson(result));
    return rows;
}

}  // namespace hshfit::jobs
