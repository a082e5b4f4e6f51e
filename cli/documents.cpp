#include "documents.h"
#include "measured_numbers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::cli {

using Json = nlohmann::ordered_json;

std::string directionText(const Direction& d) {
    return fmt::format("{:.2f},{:.2f}", degrees(polarAngle(d)), degrees(azimuth(d)));
}

Json lawsJson(const Laws& laws) {
    return {{"non_negative", laws.nonNegative},
            {"reciprocal", laws.reciprocal},
            {"isotropic", laws.isotropic},
            {"mirror_symmetric", laws.mirrorSymmetric},
            {"energy_conserving", laws.energyConserving}};
}

std::string metricText(const MetricValue& result) {
    std::string text = fmt::format("  {:<20} ", result.metric->name);
    if (!result.value) return text + "-  (" + result.reason + ")\n";
    text += fmt::format("{:<22} {}", withError(*result.value, result.error), result.metric->help);
    if (result.wi) text += "; wi " + directionText(*result.wi);
    if (result.wo) text += "; wo " + directionText(*result.wo);
    return text + "\n";
}

std::string indented(const std::string& text) {
    std::string out;
    for (std::size_t k = 0; k < text.size(); ++k) {
        out += text[k];
        if (text[k] == '\n' && k + 1 < text.size()) out += "  ";
    }
    return out;
}

}  // namespace hshfit::cli
