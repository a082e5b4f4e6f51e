#pragma once

#include <span>
#include <string>
#include <string_view>

namespace hshfit::inline pages {

/// The scale of the axis of f in figures for print. automatic: logarithmic where the drawn values
/// above 0 span a factor of more than 30.
enum class FigureAxis { automatic, linear, logarithmic };
/// "auto", "linear" or "log". Throws UsageError.
FigureAxis findFigureAxis(std::string_view name);

/// Any font without serifs.
inline constexpr std::string_view defaultFigureFont = "sans-serif";

/// The look of figures for print.
struct FigureStyle {
    double width = 84;      ///< mm, 20 to 1000: a column of a page with two
    std::string font = {};  ///< a family that fontconfig finds; empty: defaultFigureFont
    double fontSize = 8;    ///< points, 4 to 24
    FigureAxis axis = FigureAxis::automatic;
};

/// A width in mm from a number with its unit, mm, cm, in or pt (1/72 in), or a name: "column" (84
/// mm) or "page" (174 mm), the widths of Springer's instructions for artwork. Throws UsageError.
double parseFigureWidth(const std::string& text);
/// Points from 4 to 24, "8" or "8pt". Throws UsageError.
double parseFontSize(const std::string& text);
/// Throws UsageError for a width or a size of font out of range, and for a font whose name
/// is blank or holds more than letters, digits, spaces, '.', '_' and '-'.
void checkFigureStyle(const FigureStyle& style);

/// Colours as "#rrggbb" that differ in lightness, so that they stay apart in greyscale and for
/// readers who lack one kind of cones: the scheme "high-contrast" of Tol (2021, SRON/EPS/TN/09-002)
/// and black.
std::span<const std::string_view> figureInks();

}  // namespace hshfit::inline pages
