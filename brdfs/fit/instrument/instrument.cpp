#include <brdfs/fit/instrument/instrument.h>

#include <brdfs/fit/fit_samples.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace hshfit::brdfs {
namespace {

constexpr std::array cosineNames{"out", "in", "both"};

std::optional<double> numberIn(std::string_view text) {
    double value = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() ||
        !std::isfinite(value))
        return std::nullopt;
    return value;
}

InstrumentTerm termIn(std::string_view text, const char* what, double low, double high) {
    using From = InstrumentTerm::From;
    if (text.empty()) return {};
    if (text == "fit") return {From::fitted, 0};
    const auto value = numberIn(text);
    if (!value || *value < low || *value > high)
        throw UsageError(fmt::format("'{}' is no {}; valid: fit, or a number from {} to {}", text,
                                     what, low, high));
    return {From::stated, *value};
}

AngleZero zeroIn(std::string_view text) {
    constexpr std::string_view scan = ":scan";
    constexpr double most = 5;  // degrees
    if (text.empty()) return {};
    AngleZero result{AngleZero::Of::campaign, 0};
    std::string_view width = text;
    if (width.ends_with(scan)) {
        result.of = AngleZero::Of::scan;
        width.remove_suffix(scan.size());
    }
    const auto value = numberIn(width);
    if (!value || !(*value > 0) || *value > most)
        throw UsageError(fmt::format(
            "'{}' is no zero of an angle; valid: its standard uncertainty, above 0 and at most {} "
            "degrees, with :scan behind it for one for each scan, such as 0.05 or 0.05:scan",
            text, most));
    result.width = *value;
    return result;
}

}  // namespace

bool Instrument::any() const {
    using From = InstrumentTerm::From;
    return averages() || slit.finite() || offset.from != From::nothing ||
           dark.from != From::nothing || stray.from != From::nothing || scales || zeros();
}

bool InstrumentText::any() const {
    for (const std::string* text : {&source, &detector, &bandwidth, &offset, &dark, &stray, &scale,
                                    &incidenceZero, &detectorZero})
        if (!text->empty()) return true;
    return false;
}

Instrument parseInstrument(const InstrumentText& text) {
    Instrument result;
    result.source = parseAperture(text.source);
    result.detector = parseAperture(text.detector);
    if (!(text.tolerance >= 1e-10 && text.tolerance <= 0.1))
        throw UsageError(
            fmt::format("the tolerance of averages over apertures is {}, expected 1e-10 to 0.1",
                        text.tolerance));
    result.tolerance = text.tolerance;
    result.slit = parseSlit(text.bandwidth);
    constexpr double most = 1e6;  // 1/sr
    result.offset = termIn(text.offset, "offset", -most, most);
    const std::size_t colon = std::min(text.dark.find(':'), text.dark.size());
    result.dark = termIn(std::string_view(text.dark).substr(0, colon), "dark signal", -most, most);
    if (colon < text.dark.size()) {
        const std::string_view over = std::string_view(text.dark).substr(colon + 1);
        const auto found = std::ranges::find(cosineNames, over);
        if (found == cosineNames.end() || colon == 0)
            throw UsageError(fmt::format(
                "'{}' is no dark signal; valid: fit or a number, with :out, :in or :both for the "
                "cosines that divide it",
                text.dark));
        result.darkOver = static_cast<Cosines>(found - cosineNames.begin());
    }
    result.stray = termIn(text.stray, "share of stray light", 0, 0.9);
    result.incidenceZero = zeroIn(text.incidenceZero);
    result.detectorZero = zeroIn(text.detectorZero);
    if (text.scale.empty()) return result;
    result.scales = true;
    if (text.scale == "fit") return result;
    std::string_view width = text.scale;
    const bool percent = width.ends_with('%');
    if (percent) width.remove_suffix(1);
    const auto value = numberIn(width);
    if (!value || !(*value > 0) || *value > (percent ? 100 : 1))
        throw UsageError(fmt::format(
            "'{}' is no scale of scans; valid: fit, or the standard deviation about 1 that is "
            "expected, above 0 and at most 100 %, such as 2%",
            text.scale));
    result.scaleWidth = percent ? *value / 100 : *value;
    return result;
}

void checkInstrument(const Instrument& instrument, const FitSamples& samples) {
    if (samples.origin != SampleOrigin::measured)
        throw UsageError(fmt::format(
            "terms of an instrument are for readings at single pairs of directions, and these "
            "samples are {}; expected scattered measurements (ASTM, ALTA, Cornell, NIST)",
            samples.origin == SampleOrigin::cells   ? "cells of a table"
            : samples.origin == SampleOrigin::nodes ? "values of a function"
                                                    : "pixels"));
    slitMatrix(instrument.slit, samples.channels);
    const bool zeroOfScan = instrument.incidenceZero.of == AngleZero::Of::scan ||
                            instrument.detectorZero.of == AngleZero::Of::scan;
    if ((instrument.scales || zeroOfScan) && samples.scans.empty())
        throw UsageError(fmt::format(
            "a {} for each scan needs scans: say which samples belong to one (column, incidence, "
            "or the number of samples in each)",
            instrument.scales ? "scale" : "zero of an angle"));
    if (!samples.sigmas.empty()) return;
    if (instrument.scaleWidth > 0)
        throw UsageError(
            "the width of the scales of scans weighs them against the samples, whose "
            "uncertainties have to be stated too; state them, or take fit, by which the first scan "
            "is the reference");
    if (instrument.zeros())
        throw UsageError(
            "the width of the zero of an angle weighs it against the samples, whose uncertainties "
            "have to be stated too");
}

std::string_view nameOf(Cosines cosines) {
    return cosineNames[static_cast<std::size_t>(cosines)];
}

double overCosines(Cosines cosines, double cosIn, double cosOut) {
    const double in = cosines == Cosines::scatter ? 1 : cosIn;
    return 1 / (cosines == Cosines::incidence ? in : in * cosOut);
}

}  // namespace hshfit::brdfs
