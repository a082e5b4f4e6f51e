#include <hshfit/files/printable.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/internal/print_layout.h>
#include <hshfit/pages/internal/print_script.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace hshfit::embedded {
extern const std::string_view figure_panels_gp, figure_space_gp, figures_gp;
}

namespace hshfit::inline pages {
namespace {

using kainjow::mustache::data;
using Kind = PrintSeries::Kind;

constexpr std::string_view grey = "#777777", pale = "#B9C7DB";
constexpr std::array<std::string_view, 4> dashes{"1", "(9, 5)", "(2.5, 5)", "(10, 4, 2, 4)"};
constexpr std::array<int, 4> markers{6, 4, 8, 12};  ///< circle, square, triangle, diamond
constexpr double markerSize = 0.4;

std::string number(double value) {
    return scriptNumber(value);
}

std::string_view inkOf(const PrintSeries& series) {
    if (series.kind == Kind::guide) return grey;
    if (series.kind == Kind::band) return pale;
    return figureInks()[series.ink % figureInks().size()];
}

double lineWidth(const PrintSeries& series) {
    return series.kind == Kind::guide ? 0.6 : 1.4 * series.width;
}

std::string_view dashOf(const PrintSeries& series) {
    return dashes[series.dash % dashes.size()];
}

int markerOf(const PrintSeries& series) {
    return markers[series.marker % markers.size()];
}

/// The position of a tick, in the units of the drawn axis.
double drawn(const PrintAxis& axis, double at) {
    return axis.scale == PrintAxis::Scale::root ? std::sqrt(std::max(at, 0.0) / 90) : at;
}

std::string ticksOf(const PrintAxis& axis, bool labels) {
    std::string text;
    for (const AxisTick& tick : axis.ticks)
        text += fmt::format("{}{} {}{}", text.empty() ? "" : ", ",
                            gnuplotString(labels ? tick.label : ""), number(drawn(axis, tick.at)),
                            tick.minor ? " 1" : "");
    return text;
}

/// The place of values that a panel has no place for.
double floorOf(const PrintFigure& figure, const PrintPanel& panel) {
    if (panel.y.scale == PrintAxis::Scale::logarithmic) return panel.y.low;
    return figure.kind == PrintFigure::Kind::polar ? 0 : -1e300;
}

class Script {
public:
    Script(const PrintFigure& figure, const FigureStyle& style, std::size_t index,
           const FigureFrame& frame)
        : figure_(figure),
          style_(style),
          index_(index),
          layout_(layoutOf(figure, style)),
          frame_(frame) {
        if (frame_.pageWidth > 0) return;
        frame_.pageWidth = layout_.width;
        frame_.pageHeight = layout_.height;
    }

    data fields() {
        data fields;
        fields.set("index", std::to_string(index_));
        fields.set("name", figure_.name);
        fields.set(figure_.kind == PrintFigure::Kind::polar ? "polar" : "axes", true);
        fields.set("rooted", figure_.panels.front().x.scale == PrintAxis::Scale::root);
        fields.set("widthCm", number(layout_.width / 72 * 2.54));
        fields.set("heightCm", number(layout_.height / 72 * 2.54));
        fields.set("widthPt", number(std::round(layout_.width)));
        fields.set("heightPt", number(std::round(layout_.height)));
        fields.set("legend", legend());
        data panels{data::type::list};
        for (std::size_t k = 0; k < figure_.panels.size(); ++k)
            panels.push_back(panel(figure_.panels[k], layout_.panels[k]));
        fields.set("panels", panels);
        return fields;
    }

private:
    std::string across(double points) const {
        return number((frame_.left + points) / frame_.pageWidth);
    }
    std::string up(double points) const {
        return number((frame_.bottom + points) / frame_.pageHeight);
    }
    std::string wide(double points) const { return number(points / frame_.pageWidth); }
    std::string at(double x, double y) const {
        return fmt::format("screen {}, screen {}", across(x), up(y));
    }

    data legend() const {
        data statements{data::type::list};
        const auto add = [&](const std::string& text) {
            data statement;
            statement.set("statement", text);
            statements.push_back(statement);
        };
        const double size = style_.fontSize;
        for (const LegendItem& item : layout_.legend) {
            const double end = item.x + legendSample * size;
            if (item.band)
                add(
                    fmt::format("set object rectangle from {} to {} fillcolor rgb '{}' fillstyle "
                                "solid noborder",
                                at(item.x, item.y - 0.35 * size), at(end, item.y + 0.35 * size),
                                inkOf(*item.band)));
            if (item.line)
                add(
                    fmt::format("set arrow from {} to {} nohead linecolor rgb '{}' linewidth {} "
                                "dashtype {}",
                                at(item.x, item.y), at(end, item.y), inkOf(*item.line),
                                lineWidth(*item.line), dashOf(*item.line)));
            if (item.points)
                add(
                    fmt::format("set label \"\" at {} point pointtype {} pointsize {} linecolor "
                                "rgb '{}' linewidth 0.7",
                                at((item.x + end) / 2, item.y), markerOf(*item.points), markerSize,
                                inkOf(*item.points)));
            add(fmt::format("set label {} at {} left noenhanced", gnuplotString(item.label),
                            at(end + 0.5 * size, item.y)));
        }
        return statements;
    }

    data panel(const PrintPanel& panel, const PrintBox& box) {
        data fields;
        fields.set("left", across(box.left));
        fields.set("right", across(box.right));
        fields.set("bottom", up(box.bottom));
        fields.set("top", up(box.top));
        fields.set("title", gnuplotString(panel.title));
        fields.set("titleAt", up(box.top + 0.75 * style_.fontSize));
        fields.set("floor", number(floorOf(figure_, panel)));
        const bool logarithmic = panel.y.scale == PrintAxis::Scale::logarithmic;
        if (figure_.kind == PrintFigure::Kind::polar)
            setPolar(panel, fields);
        else
            setAxes(panel, box, fields);
        fields.set("logarithmic", logarithmic);
        if (figure_.kind == PrintFigure::Kind::map) setMap(panel, fields);
        data series{data::type::list};
        for (const PrintSeries& one : panel.series) series.push_back(seriesFields(one));
        fields.set("series", series);
        return fields;
    }

    void setAxes(const PrintPanel& panel, const PrintBox& box, data& fields) const {
        fields.set("xLow", number(drawn(panel.x, panel.x.low)));
        fields.set("xHigh", number(drawn(panel.x, panel.x.high)));
        fields.set("yLow", number(panel.y.low));
        fields.set("yHigh", number(panel.y.high));
        fields.set("xTicks", ticksOf(panel.x, box.labelsX));
        fields.set("yTicks", ticksOf(panel.y, box.labelsY));
        fields.set("xLabel", gnuplotString(box.labelsX ? panel.x.label : ""));
        fields.set("yLabel", gnuplotString(box.labelsY ? panel.y.label : ""));
        const double size = style_.fontSize;
        fields.set("middle", across((box.left + box.right) / 2));
        fields.set("centre", up((box.bottom + box.top) / 2));
        fields.set("xLabelAt", up(box.bottom - 2.6 * size));
        fields.set("yLabelAt", across(box.left - (ticksWidth(panel.y) + 1.6) * size));
    }

    static void setPolar(const PrintPanel& panel, data& fields) {
        const bool logarithmic = panel.y.scale == PrintAxis::Scale::logarithmic;
        const auto radius = [&](double value) {
            return logarithmic
                       ? std::log10(value / panel.y.low) / std::log10(panel.y.high / panel.y.low)
                       : value / panel.y.high;
        };
        fields.set("polarLogarithmic", logarithmic ? "1" : "0");
        fields.set("polarLow", number(logarithmic ? std::log10(panel.y.low) : 0));
        fields.set("polarHigh", number(logarithmic ? std::log10(panel.y.high) : panel.y.high));
        data rings{data::type::list}, curves{data::type::list};
        for (const AxisTick& tick : panel.y.ticks) {
            const double at = radius(tick.at);
            if (tick.label.empty() || at < 0.05 || at > 1.001) continue;
            data ring;
            ring.set("at", number(at));
            ring.set("label", gnuplotString(tick.label));
            rings.push_back(ring);
            curves.push_back(ring);
        }
        data edge;
        edge.set("at", "1");
        curves.push_back(edge);
        fields.set("rings", rings);
        fields.set("ringCurves", curves);
        fields.set("polar", true);
        fields.set("arrow", number(panel.x.high));
    }

    void setMap(const PrintPanel& panel, data& fields) const {
        fields.set("map", true);
        fields.set("zLow", number(panel.colours.low));
        fields.set("zHigh", number(panel.colours.high));
        fields.set("zTicks", ticksOf(panel.colours, true));
        fields.set("barGap", wide(0.6 * style_.fontSize));
        fields.set("barWidth", wide(0.8 * style_.fontSize));
    }

    data seriesFields(const PrintSeries& series) {
        data fields;
        const bool polar = figure_.kind == PrintFigure::Kind::polar;
        fields.set("figure", std::to_string(index_));
        fields.set("first", std::to_string(row_));
        row_ += series.x.size();
        fields.set("last", std::to_string(row_ - 1));
        fields.set("ink", std::string(inkOf(series)));
        if (series.x.empty()) return fields;
        if (figure_.kind == PrintFigure::Kind::map) {
            fields.set("image", true);
            return fields;
        }
        switch (series.kind) {
            case Kind::line:
            case Kind::guide:
                fields.set("line", true);
                break;
            case Kind::band:
                fields.set(polar ? "ends" : "band", true);
                break;
            case Kind::points:
                fields.set("points", true);
                fields.set("bars", !series.low.empty());
                break;
        }
        fields.set("width", number(lineWidth(series)));
        fields.set("dash", std::string(dashOf(series)));
        fields.set("marker", std::to_string(markerOf(series)));
        fields.set("size", number(markerSize));
        return fields;
    }

    const PrintFigure& figure_;
    const FigureStyle& style_;
    std::size_t index_, row_ = 0;
    PrintLayout layout_;
    FigureFrame frame_;
};

std::string cell(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : printable(text)) out += c == '"' ? "\"\"" : std::string(1, c);
    return out + '"';
}

}  // namespace

std::string scriptNumber(double value) {
    return fmt::format("{:.7g}", value);
}

data figureFields(const PrintFigure& figure, const FigureStyle& style, std::size_t index,
                  const FigureFrame& frame) {
    return Script(figure, style, index, frame).fields();
}

void addFigureTemplates(data& fields) {
    using kainjow::mustache::partial;
    fields.set("figureSpace", data(partial([] { return std::string(embedded::figure_space_gp); })));
    fields.set("figurePanels",
               data(partial([] { return std::string(embedded::figure_panels_gp); })));
}

std::string figuresScript(const std::vector<PrintFigure>& figures, const FigureStyle& style) {
    data fields, list{data::type::list};
    fields.set("font", style.font.empty() ? std::string(defaultFigureFont) : style.font);
    fields.set("fontSize", number(style.fontSize));
    fields.set("ringFont", number(0.8 * style.fontSize));
    for (std::size_t k = 0; k < figures.size(); ++k)
        list.push_back(figureFields(figures[k], style, k + 1));
    fields.set("figures", list);
    addFigureTemplates(fields);
    return filledPage(embedded::figures_gp, fields);
}

std::string figureCsv(const PrintFigure& figure) {
    // Maps have a value at two coordinates; the place of the high end stays empty.
    const bool map = figure.kind == PrintFigure::Kind::map;
    std::string text =
        fmt::format("panel,title,series,{0},{1},", figure.columns[0], figure.columns[1]) +
        (map ? "value,\n" : fmt::format("{0}_low,{0}_high\n", figure.columns[1]));
    for (std::size_t p = 0; p < figure.panels.size(); ++p)
        for (const PrintSeries& series : figure.panels[p].series)
            for (std::size_t k = 0; k < series.x.size(); ++k) {
                const auto of = [&](const std::vector<double>& values) {
                    return k < values.size() ? cell(values[k]) : std::string();
                };
                fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", p + 1,
                               quoted(figure.panels[p].title), quoted(series.label),
                               cell(series.x[k]), of(series.y), of(series.low), of(series.high));
            }
    return text;
}

}  // namespace hshfit::inline pages
