#pragma once

// Pieces of the answers that several commands give.

#include <hshfit/accuracy/metrics.h>

#include <jobs/common/direction_json.h>
#include <jobs/common/metric_json.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace hshfit::cli {

using jobs::directionJson;
using jobs::metricJson;
using jobs::metricValuesJson;

/// "52.00,10.00": theta and phi in degrees.
std::string directionText(const Direction& d);

nlohmann::ordered_json lawsJson(const Laws& laws);

/// Every line after the first begins with two spaces.
std::string indented(const std::string& text);

/// An indented line with its line feed.
std::string metricText(const MetricValue& result);

}  // namespace hshfit::cli
