#include "form_options.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::cli {

using Json = nlohmann::ordered_json;

void FormOptions::addTo(CLI::App& command) {
    const auto option = [&](const char* name, auto& value, const char* help) {
        return command.add_option(name, value, help)->group("Form");
    };
    const auto flag = [&](const char* name, bool& value, const char* help) {
        command.add_flag(name, value, help)->group("Form");
    };
    option(
        "--form", form_,
        "outgoing (coefficients per outgoing direction), basis (both directions in the basis) or "
        "halfway (a smooth part and a lobe over the half and the difference vector)");
    option("--halfway", halfway_,
           "With --form halfway: functions along each axis, as 9,8,6 (default: by symmetry, a "
           "kilobyte)");
    flag("--reciprocal", reciprocal_, "With --form basis: the symmetric half only");
    option("--split", split_,
           "diffuse, or a BRDF or FIT.json: kept exactly beside the coefficients of the remainder");
    option("--window", window_, "Against ringing: hann, lanczos or bending");
    flag("--non-negative", nonNegative_, "The nearest coefficients whose sum is nowhere negative");
    flag("--energy-preserving", energyPreserving_,
         "The nearest coefficients whose directional albedo is never above that of the BRDF");
    option("--rank", rank_, "Factor the coefficients (SVD) and keep this many factors")
        ->check(CLI::Range(1, 100000));
    option("--rank-error", rankError_, "The least rank within this relative change")
        ->check(CLI::Range(1e-12, 1.0));
    flag("--non-negative-factors", nonNegativeFactors_,
         "With --rank: factors that are nowhere < 0");
    option("--keep", keep_, "Keep the largest numbers of each array, this many, and a mask")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 40));
    option("--precision", precision_,
           "float64, float32, half, unorm16 or unorm8 (default: float32; without any of these "
           "options, plain coefficients in float64)");
}

std::optional<Form> FormOptions::build() const {
    const bool asked = !form_.empty() || !halfway_.empty() || !window_.empty() ||
                       !precision_.empty() || !split_.empty() || reciprocal_ || nonNegative_ ||
                       energyPreserving_ || nonNegativeFactors_ || rank_ > 0 || rankError_ > 0 ||
                       keep_ > 0;
    if (!asked) return std::nullopt;
    Form form;
    if (!form_.empty()) form.kind = parseKind(form_);
    if (!halfway_.empty()) {
        if (form.kind != Representation::Kind::halfway) {
            throw UsageError("--halfway belongs to --form halfway");
        }
        form.halfway = parseHalfway(halfway_);
    }
    if (!window_.empty()) form.window = parseWindow(window_);
    if (!precision_.empty()) form.precision = parsePrecision(precision_);
    form.split = split_;
    form.reciprocal = reciprocal_;
    form.nonNegative = nonNegative_;
    form.energyPreserving = energyPreserving_;
    form.nonNegativeFactors = nonNegativeFactors_;
    form.rank = rank_;
    form.rankError = rankError_;
    form.keep = keep_;
    return form;
}

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
