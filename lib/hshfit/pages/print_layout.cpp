#include <hshfit/pages/internal/print_layout.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline pages {
namespace {

constexpr double pointsPerMillimetre = 72 / 25.4;
constexpr double characterWidth = 0.6;  ///< the mean of most fonts, in sizes of the font

/// Width of a text in sizes of the font: raised and lowered characters are smaller, and the marks
/// that make them so are not seen.
double widthOf(const std::string& text) {
    double width = 0;
    bool small = false, group = false;
    for (const char c : text) {
        if ((static_cast<unsigned char>(c) & 0xc0) == 0x80) continue;
        if (c == '^' || c == '_') {
            small = true;
        } else if (c == '{') {
            group = true;
        } else if (c == '}') {
            small = group = false;
        } else {
            width += characterWidth * (small ? 0.8 : 1);
            small = small && group;
        }
    }
    return width;
}

std::size_t columnsOf(const PrintFigure& figure, const FigureStyle& style) {
    const std::size_t most = style.width < 120 ? 2 : style.width < 220 ? 3 : 4;
    // Four panels are two by two.
    const std::size_t fit = figure.panels.size() == 4 ? std::min<std::size_t>(most, 2) : most;
    return std::clamp<std::size_t>(figure.panels.size(), 1, fit);
}

std::vector<LegendItem> itemsOf(const PrintFigure& figure) {
    std::vector<LegendItem> items;
    for (const PrintPanel& panel : figure.panels)
        for (const PrintSeries& series : panel.series) {
            if (series.label.empty()) continue;
            auto item = std::ranges::find(items, series.label, &LegendItem::label);
            if (item == items.end()) {
                items.push_back({.label = series.label});
                item = items.end() - 1;
            }
            const PrintSeries*& place = series.kind == PrintSeries::Kind::points ? item->points
                                        : series.kind == PrintSeries::Kind::band ? item->band
                                                                                 : item->line;
            if (!place) place = &series;
        }
    return items;
}

/// Breaks the items into rows, from the top; y counts rows from the last one.
std::size_t breakIntoRows(std::vector<LegendItem>& items, double width, double size) {
    constexpr double gap = 1.2;
    std::size_t row = 0;
    double x = 0;
    for (LegendItem& item : items) {
        const double needed = size * (legendSample + 0.5 + widthOf(item.label));
        if (x > 0 && x + needed > width) {
            ++row;
            x = 0;
        }
        item.x = x;
        item.y = static_cast<double>(row);
        x += needed + gap * size;
    }
    const std::size_t rows = items.empty() ? 0 : row + 1;
    for (LegendItem& item : items) item.y = static_cast<double>(row) - item.y;
    return rows;
}

/// Space around each panel, in points.
struct Margins {
    double left, right, bottom, top;
};

Margins marginsOf(const PrintFigure& figure, double size) {
    const double title = 1.5 * size;
    if (figure.kind == PrintFigure::Kind::polar) return {0.3 * size, 0.3 * size, 0.2 * size, title};
    double ticks = 0;
    for (const PrintPanel& panel : figure.panels) ticks = std::max(ticks, ticksWidth(panel.y));
    Margins margins{(2.4 + ticks) * size, 1.2 * size, 3.5 * size, title};
    if (figure.kind == PrintFigure::Kind::map) margins.right = 5.5 * size;
    return margins;
}

double heightOver(const PrintFigure& figure, std::size_t columns) {
    switch (figure.kind) {
        case PrintFigure::Kind::polar:
            return 1.28 / 2.24;
        case PrintFigure::Kind::map:
            return 0.8;
        case PrintFigure::Kind::axes:
            break;
    }
    return columns == 1 ? 0.62 : 0.85;
}

}  // namespace

double textWidth(const std::string& text) {
    return characterWidth * static_cast<double>(std::ranges::count_if(text, [](char c) {
               return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
           }));
}

double ticksWidth(const PrintAxis& axis) {
    double width = 0;
    for (const AxisTick& tick : axis.ticks) width = std::max(width, widthOf(tick.label));
    return width;
}

PrintLayout layoutOf(const PrintFigure& figure, const FigureStyle& style) {
    const double size = style.fontSize;
    const std::size_t count = figure.panels.size(), columns = columnsOf(figure, style);
    const std::size_t rows = (count + columns - 1) / columns;
    const Margins margins = marginsOf(figure, size);
    // Panels that share axes stand close to one another.
    const bool close = figure.shared && figure.kind == PrintFigure::Kind::axes;
    const double between = close ? 0.8 * size : margins.left + margins.right;
    const double below = close ? 0.5 * size : margins.bottom;

    PrintLayout layout{.width = style.width * pointsPerMillimetre};
    layout.legend = itemsOf(figure);
    const auto n = static_cast<double>(columns);
    const double inner = layout.width - margins.left - margins.right - (n - 1) * between;
    const double width = std::max(inner / n, 2 * size);
    // Columns that can be parted leave the legend whole.
    const double legendWidth =
        (close ? layout.width : margins.left + width + margins.right) - 2 * size;
    const double legend =
        1.5 * size * static_cast<double>(breakIntoRows(layout.legend, legendWidth, size)) +
        0.3 * size;
    const double height = width * heightOver(figure, columns);
    const double rowHeight = margins.top + height;
    layout.height = legend + margins.bottom + static_cast<double>(rows) * rowHeight +
                    static_cast<double>(rows - 1) * below;
    for (LegendItem& item : layout.legend) {
        item.x += size;
        item.y = (item.y * 1.5 + 0.9) * size;
    }
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t row = k / columns, column = k % columns;
        const double left = margins.left + static_cast<double>(column) * (width + between);
        const double top =
            layout.height - margins.top - static_cast<double>(row) * (rowHeight + below);
        layout.panels.push_back({left, left + width, top - height, top,
                                 !close || k + columns >= count, !close || column == 0});
    }
    return layout;
}

std::vector<int> figureColumns(const PrintFigure& figure, const FigureStyle& style) {
    std::vector<int> columns;
    if (figure.shared) return columns;
    const double margin = marginsOf(figure, style.fontSize).left;
    for (const PrintBox& box : layoutOf(figure, style).panels) {
        const int left = static_cast<int>(box.left - margin);
        if (!columns.empty() && left <= columns.back()) break;
        columns.push_back(left);
    }
    return columns;
}

std::array<double, 2> figureSize(const PrintFigure& figure, const FigureStyle& style) {
    const PrintLayout layout = layoutOf(figure, style);
    return {layout.width / pointsPerMillimetre, layout.height / pointsPerMillimetre};
}

}  // namespace hshfit::inline pages
