#include <hshfit/error.h>
#include <hshfit/files/printable.h>
#include <hshfit/pages/figure_style.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace hshfit::inline pages {
namespace {

constexpr double leastWidth = 20, mostWidth = 1000, leastFont = 4, mostFont = 24;

/// A finite number and what stands behind it.
std::optional<std::pair<double, std::string_view>> numberWithUnit(std::string_view text) {
    double number = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    if (parsed.ec != std::errc() || !std::isfinite(number)) return std::nullopt;
    std::string_view unit = text.substr(static_cast<std::size_t>(parsed.ptr - text.data()));
    unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
    return std::pair{number, unit};
}

bool isFontName(std::string_view name) {
    const auto fits = [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte >= 0x80 || std::isalnum(byte) != 0 ||
               std::string_view(" ._-").find(c) != std::string_view::npos;
    };
    return name.find_first_not_of(' ') != std::string_view::npos && std::ranges::all_of(name, fits);
}

}  // namespace

FigureAxis findFigureAxis(std::string_view name) {
    if (name == "auto") return FigureAxis::automatic;
    if (name == "linear") return FigureAxis::linear;
    if (name == "log") return FigureAxis::logarithmic;
    throw UsageError(fmt::format("the axis of f is auto, linear or log, not '{}'", name));
}

double parseFigureWidth(const std::string& text) {
    constexpr std::pair<std::string_view, double> named[] = {{"column", 84}, {"page", 174}};
    constexpr std::pair<std::string_view, double> units[] = {
        {"mm", 1}, {"cm", 10}, {"in", 25.4}, {"pt", 25.4 / 72}};
    for (const auto& [name, width] : named)
        if (text == name) return width;
    if (const auto number = numberWithUnit(text))
        for (const auto& [unit, millimetres] : units)
            if (number->second == unit) {
                const FigureStyle style{.width = number->first * millimetres};
                checkFigureStyle(style);
                return style.width;
            }
    throw UsageError(
        fmt::format("the width of a figure is column, page, or a number with its unit, mm, cm, in "
                    "or pt (84mm), "
                    "not '{}'",
                    text));
}

double parseFontSize(const std::string& text) {
    const auto number = numberWithUnit(text);
    if (!number || (!number->second.empty() && number->second != "pt"))
        throw UsageError(
            fmt::format("the size of a font is a number of points (8 or 8pt), not '{}'", text));
    FigureStyle style;
    style.fontSize = number->first;
    checkFigureStyle(style);
    return style.fontSize;
}

void checkFigureStyle(const FigureStyle& style) {
    if (!(style.width >= leastWidth && style.width <= mostWidth))
        throw UsageError(fmt::format("a figure is {} to {} mm wide, not {:.6g}", leastWidth,
                                     mostWidth, style.width));
    if (!(style.fontSize >= leastFont && style.fontSize <= mostFont))
        throw UsageError(fmt::format("a font has {} to {} points, not {:.6g}", leastFont, mostFont,
                                     style.fontSize));
    if (!style.font.empty() && !isFontName(style.font))
        throw UsageError(fmt::format(
            "'{}' is no name of a font: letters, digits, spaces, '.', '_' and '-'", style.font));
}

std::span<const std::string_view> figureInks() {
    static constexpr std::array<std::string_view, 4> inks{"#004488", "#BB5566", "#DDAA33",
                                                          "#000000"};
    return inks;
}

}  // namespace hshfit::inline pages
