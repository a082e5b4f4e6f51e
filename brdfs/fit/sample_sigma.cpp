#include <brdfs/fit/sample_sigma.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace hshfit::brdfs {
namespace {

UsageError noUncertainty(std::string_view text) {
    return UsageError(fmt::format(
        "'{}' is no uncertainty; valid: a relative part (2%), an absolute one in 1/sr (0.001), "
        "their sum (2%+0.001), column, or a file NAME.csv",
        text));
}

}  // namespace

SigmaStatement parseSigma(std::string_view text) {
    using From = SigmaStatement::From;
    SigmaStatement result;
    result.text = text;
    if (text.empty()) return result;
    if (text == "column") {
        result.from = From::column;
        return result;
    }
    if (text.ends_with(".csv")) {
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
