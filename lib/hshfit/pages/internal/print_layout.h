#pragma once

// Places of the panels and of the legend of a figure for print.

#include <hshfit/pages/print_figure.h>

#include <string>
#include <vector>

namespace hshfit::inline pages {

/// The box of a panel, in points from the lower left corner.
struct PrintBox {
    double left = 0, right = 0, bottom = 0, top = 0;
    bool labelsX = true, labelsY = true;  ///< whether its ticks have labels
};

/// A sample in the legend with its text, at points from the lower left corner.
struct LegendItem {
    const PrintSeries* line = nullptr;
    const PrintSeries* points = nullptr;
    const PrintSeries* band = nullptr;
    std::string label = {};
    double x = 0, y = 0;
};

struct PrintLayout {
    double width = 0, height = 0;  ///< points
    std::vector<PrintBox> panels = {};
    std::vector<LegendItem> legend = {};
};

/// Length of the samples in the legend, in sizes of the font.
inline constexpr double legendSample = 2.2;

/// The width of the widest label of an axis, in sizes of the font.
double ticksWidth(const PrintAxis& axis);

/// The width of a text on one line, in sizes of the font: an estimate for most fonts.
double textWidth(const std::string& text);

PrintLayout layoutOf(const PrintFigure& figure, const FigureStyle& style);

}  // namespace hshfit::inline pages
