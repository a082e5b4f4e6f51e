#pragma once

#include <hshfit/accuracy/metrics.h>

#include <nlohmann/json_fwd.hpp>

#include <vector>

namespace hshfit::jobs {

/// {"name", "value" (null where there is none), "error", "reason", "at": {"wi", "wo"}}
nlohmann::ordered_json metricJson(const MetricValue& result);
nlohmann::ordered_json metricValuesJson(const std::vector<MetricValue>& results);

}  // namespace hshfit::jobs
