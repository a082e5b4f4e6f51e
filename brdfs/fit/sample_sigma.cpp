#include <brdfs/fit/sample_sigma.h>

#include <hshfit/brdf/directions.h>
#include <hshfit/error.h>
#include <hshfit/files/extension.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hshfit::brdfs {
namespace {

UsageError noUncertainty(std::string_view text) {
    return UsageError(fmt::format(
        "'{}' is no uncertainty; valid: a relative part (2%), an absolute one in 1/sr (0.001), "
        "their sum (2%+0.001), column, or a file NAME.csv; with ',correlation:angle=3deg', "
        "',correlation:wavelength=20nm' or ',covariance=FILE' behind it for errors that are not "
        "independent",
        text));
}

constexpr std::string_view correlationMark = ",correlation:", fileMark = ",covariance=";

/// "angle=3deg", "wavelength=20nm" or both.
SigmaCorrelation correlationIn(std::string_view list, std::string_view text) {
    SigmaCorrelation result;
    while (!list.empty()) {
        const std::string_view entry = list.substr(0, list.find(','));
        const bool angle = entry.starts_with("angle="),
                   wavelength = entry.starts_with("wavelength=");
        double& length = angle ? result.angle : result.wavelength;
        const std::string_view number = entry.substr(std::min(entry.find('=') + 1, entry.size()));
        double value = 0;
        const auto parsed = std::from_chars(number.data(), number.data() + number.size(), value);
        const std::string_view unit(parsed.ptr, number.data() + number.size());
        if (!(angle || wavelength) || length > 0 || parsed.ec != std::errc() || !(value > 0) ||
            !std::isfinite(value) || !(unit.empty() || unit == (angle ? "deg" : "nm")))
            throw UsageError(fmt::format(
                "'{}' states no correlation of uncertainties; valid: correlation:angle=3deg, "
                "correlation:wavelength=20nm or correlation:angle=3deg,wavelength=20nm",
                text));
        length = angle ? radians(value) : value;
        list.remove_prefix(std::min(entry.size() + 1, list.size()));
    }
    if (!result.any())
        throw UsageError(fmt::format(
            "'{}' states no length of the correlation; valid: correlation:angle=3deg, for example",
            text));
    return result;
}

}  // namespace

SigmaStatement parseSigma(std::string_view text) {
    using From = SigmaStatement::From;
    if (const std::size_t mark = text.find(correlationMark); mark != text.npos) {
        SigmaStatement result = parseSigma(text.substr(0, mark));
        if (result.from == From::nothing) throw noUncertainty(text);
        result.correlation = correlationIn(text.substr(mark + correlationMark.size()), text);
        result.text = text;
        return result;
    }
    if (const std::size_t mark = text.find(fileMark); mark != text.npos) {
        SigmaStatement result = parseSigma(text.substr(0, mark));
        const std::string path(text.substr(mark + fileMark.size()));
        if (result.from == From::nothing) throw noUncertainty(text);
        if (path.empty()) throw UsageError(fmt::format("'{}' names no file of correlations", text));
        result.correlation.blocks = readCorrelations(path);
        result.text = text;
        return result;
    }
    SigmaStatement result;
    result.text = text;
    if (text.empty()) return result;
    if (text == "column") {
        result.from = From::column;
        return result;
    }
    if (extensionOf(std::string(text)) == ".csv") {
        result.from = From::file;
        result.path = text;
        return result;
    }
    result.from = From::formula;
    bool relative = false, absolute = false;
    for (std::string_view rest = text;;) {
        double value = 0;
        const auto parsed = std::from_chars(rest.data(), rest.data() + rest.size(), value);
        if (parsed.ec != std::errc() || !(value > 0) || !std::isfinite(value))
            throw noUncertainty(text);
        rest.remove_prefix(static_cast<std::size_t>(parsed.ptr - rest.data()));
        const bool percent = rest.starts_with('%');
        if (percent) rest.remove_prefix(1);
        if (percent ? relative : absolute) throw noUncertainty(text);
        (percent ? relative : absolute) = true;
        (percent ? result.relative : result.absolute) = percent ? value / 100 : value;
        if (rest.empty()) return result;
        if (!rest.starts_with('+')) throw noUncertainty(text);
        rest.remove_prefix(1);
    }
}

ScanStatement parseScans(std::string_view text) {
    using From = ScanStatement::From;
    ScanStatement result;
    result.text = text;
    if (text.empty()) return result;
    if (text == "column") {
        result.from = From::column;
    } else if (text == "incidence") {
        result.from = From::incidence;
    } else {
        const auto parsed = std::from_chars(text.data(), text.data() + text.size(), result.length);
        if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() ||
            result.length == 0)
            throw UsageError(fmt::format(
                "'{}' names no scans; valid: column, incidence, or the number of samples in each",
                text));
        result.from = From::runs;
    }
    return result;
}

}  // namespace hshfit::brdfs
