#include "form_lines.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::cli {

using Json = nlohmann::ordered_json;

Json describeForm(const Representation& r) {
    Json steps = Json::array();
    for (const RepresentationStep& step : r.steps) {
        const bool known = std::isfinite(step.change);
        steps.push_back(
            {{"what", step.what}, {"change", known ? Json(step.change) : Json(nullptr)}});
    }
    Json out = {{"kind", kindName(r.kind())},
                {"numbers", r.numbers()},
                {"bytes", r.bytes()},
                {"entropy_bytes", r.entropyBytes()},
                {"steps", steps}};
    if (!r.added.empty()) out["added"] = r.added;
    return out;
}

std::string formLine(const Representation& r) {
    std::string text = fmt::format("  form {}: {} numbers, {} bytes ({} after Zstandard)\n",
                                   kindName(r.kind()), r.numbers(), r.bytes(), r.entropyBytes());
    if (!r.added.empty()) text += fmt::format("  added exactly: {}\n", r.added);
    for (const RepresentationStep& step : r.steps) {
        const bool linear = r.kind() != Representation::Kind::halfway;
        text += linear ? fmt::format("  {}: changes it by {:.3g} (relative L2)\n", step.what,
                                     step.change)
                       : fmt::format("  {}: {:.3g}\n", step.what, step.change);
    }
    return text;
}

}  // namespace hshfit::cli
