#include <brdfs/fit/instrument/instrument_text.h>
#include <brdfs/fit/printed_number.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace hshfit::brdfs {
namespace {

using From = InstrumentTerm::From;

std::string textOf(const Aperture& aperture) {
    if (aperture.shape == Aperture::Shape::cone)
        return fmt::format("cone of half angle {:.6g} degrees", degrees(aperture.half));
    return fmt::format("rectangle of half angles {:.6g} and {:.6g} degrees", degrees(aperture.half),
                       degrees(aperture.across));
}

std::string textOf(const InstrumentTerm& term, const std::vector<double>& values,
                   std::string_view unit) {
    if (values.empty()) return {};
    const auto [low, high] = std::ranges::minmax_element(values);
    std::string text = plainValue(*low);
    if (*low != *high) text += fmt::format(" to {}", plainValue(*high));
    return fmt::format("{}{}{}, {}", text, unit.empty() ? "" : " ", unit,
                       term.fitted() ? "fitted" : "stated");
}

std::string textOf(const AngleZero& zero, const std::vector<double>& values) {
    const auto [low, high] = std::ranges::minmax_element(values);
    return fmt::format("{}{} degrees, expected 0 within {:.3g}{}", plainValue(*low, 3),
                       *low == *high ? std::string() : fmt::format(" to {}", plainValue(*high, 3)),
                       zero.width, zero.of == AngleZero::Of::scan ? ", one for each scan" : "");
}

/// The root mean square of scales about 1.
double spreadOf(const std::vector<double>& scales) {
    double squares = 0;
    for (const double scale : scales) squares += (scale - 1) * (scale - 1);
    return std::sqrt(squares / static_cast<double>(scales.size()));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> instrumentRows(const FittedInstrument& fitted) {
    const Instrument& own = fitted.instrument;
    std::vector<std::pair<std::string, std::string>> rows;
    if (own.source.finite()) rows.emplace_back("source aperture", textOf(own.source));
    if (own.detector.finite()) rows.emplace_back("detector aperture", textOf(own.detector));
    if (own.averages())
        rows.emplace_back("averages over apertures",
                          fmt::format("to {} of f, {} pairs of directions",
                                      plainValue(fitted.averageChange, 2), fitted.nodes));
    if (own.slit.finite()) rows.emplace_back("bandwidth", own.slit.text + " nm");
    if (!fitted.scales.empty()) {
        const auto [low, high] = std::ranges::minmax_element(fitted.scales);
        rows.emplace_back(
            "scales of scans",
            fmt::format("{} of them, {:.4g} to {:.4g}, {:.2g} about 1 in squares{}",
                        fitted.scales.size(), *low, *high, spreadOf(fitted.scales),
                        own.scaleWidth > 0 ? fmt::format(", expected {:.3g}", own.scaleWidth)
                                           : std::string(", free")));
    }
    if (!fitted.incidenceZeros.empty())
        rows.emplace_back("zero of incidence", textOf(own.incidenceZero, fitted.incidenceZeros));
    if (!fitted.detectorZeros.empty())
        rows.emplace_back("zero of the detector", textOf(own.detectorZero, fitted.detectorZeros));
    if (own.stray.from != From::nothing)
        rows.emplace_back("stray light", textOf(own.stray, {fitted.stray}, ""));
    if (own.offset.from != From::nothing)
        rows.emplace_back("offset", textOf(own.offset, fitted.offset, "1/sr"));
    if (own.dark.from != From::nothing)
        rows.emplace_back(
            "dark signal",
            fmt::format("{}, over the cosine of {}", textOf(own.dark, fitted.dark, "1/sr"),
                        own.darkOver == Cosines::scatter     ? "theta_o"
                        : own.darkOver == Cosines::incidence ? "theta_i"
                                                             : "both angles"));
    return rows;
}

}  // namespace hshfit::brdfs
