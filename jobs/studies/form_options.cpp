#include "form_options.h"

#include <jobs/common/option_words.h>

#include <hshfit/error.h>

#include <fmt/format.h>

namespace hshfit::jobs {
namespace {

using options::at;
using options::spelled;

constexpr OptionRow formRows[] = {
    OptionRow{
        "form", spelled<parseKind, kindName, &FormOptions::kind>,
        "outgoing (coefficients per outgoing direction), basis (both directions in the basis) or "
        "halfway (a smooth part and a lobe over the half and the difference vector)"}
        .takes({.words = formWords}),
    OptionRow{"halfway", at<&FormOptions::halfway>,
              "With --form halfway: functions along each axis, as 9,8,6 (default: by symmetry, a "
              "kilobyte)"}
        .takes({.syntax = Syntax::list}),
    OptionRow{"reciprocal", at<&FormOptions::reciprocal>,
              "With --form basis or halfway: the symmetric half only"},
    OptionRow{
        "split", at<&FormOptions::split>,
        "diffuse, or a BRDF or FIT.json: kept exactly beside the coefficients of the remainder"}
        .takes({splitWords, Syntax::brdf, Files::read, ""}),
    OptionRow{"window", spelled<parseWindow, windowName, &FormOptions::window>,
              "Against ringing: hann, lanczos or bending"}
        .takes({.words = windowWords}),
    OptionRow{"non-negative", at<&FormOptions::nonNegative>,
              "The nearest coefficients whose sum is nowhere negative"},
    OptionRow{"energy-preserving", at<&FormOptions::energyPreserving>,
              "The nearest coefficients whose directional albedo is never above that of the BRDF"},
    OptionRow{"rank", at<&FormOptions::rank>,
              "Factor the coefficients (SVD) and keep this many factors"}
        .within(Bounds<int>{1, 100000}),
    OptionRow{"rank-error", at<&FormOptions::rankError>,
              "The least rank within this relative change"}
        .within(Bounds<double>{1e-12, 1}),
    OptionRow{"non-negative-factors", at<&FormOptions::nonNegativeFactors>,
              "With --rank: factors that are nowhere < 0"},
    OptionRow{"keep", at<&FormOptions::keep>,
              "Keep the largest numbers of each array, this many, and a mask"}
        .within(Bounds<double>{1, 0x1p40}),
    OptionRow{"precision", spelled<parsePrecision, precisionName, &FormOptions::precision>,
              "float64, float32, half, unorm16 or unorm8 (default: float32; without any of these "
              "options, plain coefficients in float64)"}
        .takes({.words = precisionWords}),
};

}  // namespace

OptionRows<FormOptions> formOptions() {
    return {formRows};
}

std::optional<Form> FormOptions::form() const {
    if (*this == FormOptions{}) return std::nullopt;
    Form made;
    made.kind = kind.value_or(made.kind);
    if (!halfway.empty()) {
        if (made.kind != Representation::Kind::halfway)
            throw UsageError(fmt::format("{} belongs to {}", Setting{"Form::halfway"},
                                         Setting{"Form::kind", "halfway"}));
        made.halfway = parseHalfway(halfway);
    }
    made.reciprocal = reciprocal;
    made.split = split;
    made.window = window.value_or(made.window);
    made.nonNegative = nonNegative;
    made.energyPreserving = energyPreserving;
    made.rank = rank;
    made.rankError = rankError;
    made.nonNegativeFactors = nonNegativeFactors;
    made.keep = keep;
    made.precision = precision.value_or(made.precision);
    return made;
}

}  // namespace hshfit::jobs
