#pragma once

#include <hshfit/brdf/channels.h>
#include <hshfit/files/file_set.h>
#include <hshfit/pages/axis_ticks.h>
#include <hshfit/pages/figure_style.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::inline pages {

/// Data of one kind in a panel.
struct PrintSeries {
    enum class Kind {
        line,    ///< a gap where y is no number, and where it has no place on the axis
        band,    ///< between low and high
        points,  ///< markers, with bars from low to high where these are given
        guide    ///< a thin grey line
    };
    Kind kind = Kind::line;
    std::string label = {};  ///< in the legend; series with one label share an item; empty: none
    std::size_t ink = 0;     ///< of figureInks()
    std::size_t dash = 0;    ///< of a line: solid, dashed, dotted, dash-dotted
    std::size_t marker = 0;  ///< circle, square, triangle, diamond
    double width = 1;        ///< of a line, relative
    std::vector<double> x = {}, y = {};       ///< as long as one another
    std::vector<double> low = {}, high = {};  ///< as long as x, or empty
};

struct PrintAxis {
    enum class Scale { linear, logarithmic, root };  ///< root: sqrt(x / 90), as of theta_h
    std::string label = {};                          ///< as gnuplot sets it: f_r, sr^{−1}
    double low = 0, high = 1;
    Scale scale = Scale::linear;
    std::vector<AxisTick> ticks = {};
};

struct PrintPanel {
    std::string title = {};  ///< set likewise
    PrintAxis x = {}, y = {};
    std::vector<PrintSeries> series = {};
    PrintAxis colours = {};  ///< of a map
};

/// A figure for print: panels in rows.
struct PrintFigure {
    enum class Kind {
        axes,
        polar,  ///< x is an angle in degrees from the normal, y the radius
        map     ///< one series, y against x with its values in `low`, one colour scale
    };
    std::string name = {};  ///< of its files, without extension
    Kind kind = Kind::axes;
    bool shared = true;  ///< panels have the same axes: ticks have labels at the margins alone
    std::array<std::string, 2> columns = {"x", "y"};  ///< names in the CSV file
    std::vector<PrintPanel> panels = {};
};

/// The ink of a drawn channel, by its place among the drawn channels: red, yellow and blue inks for
/// R, G and B.
std::size_t channelInk(Channels::Kind kind, std::size_t place);

/// The range and ticks of an axis of f for values: `style.axis`, with 0 on a linear one. On a
/// logarithmic one, of at most 6 decades, values at or below its low end have no place: markers
/// become triangles at that end, and lines end.
PrintAxis axisOf(const std::vector<double>& values, FigureAxis scale, const std::string& label);
/// A linear one, with these ends.
PrintAxis linearAxis(double low, double high, const std::string& label, int ticks = 5);

/// The script for gnuplot, and the data of one figure: panel, its title, series, x, y, low, high.
std::string figuresScript(const std::vector<PrintFigure>& figures, const FigureStyle& style);
std::string figureCsv(const PrintFigure& figure);
/// Width and height in mm: the style's width, and the height that panels and legend need.
std::array<double, 2> figureSize(const PrintFigure& figure, const FigureStyle& style);
/// The left ends of the columns of panels, in points, for inlinedFigure(). None where panels share
/// axes: only the first column has the labels of its ticks.
std::vector<int> figureColumns(const PrintFigure& figure, const FigureStyle& style);

/// The files of figures in a set that is yet to be committed.
struct AddedFigures {
    std::vector<std::string> names = {};
    /// The reason that there is no .pdf and no .svg: gnuplot is missing or failed.
    std::optional<std::string> undrawn = {};
    std::string font = {};  ///< in the PDFs, where it is not the one that was asked for
    std::vector<std::string> svgs = {};  ///< documents, in the order of the figures, if drawn
};

/// Adds NAME.csv, NAME.pdf and NAME.svg for each figure, and figures.gp, which draws them again.
/// PDFs embed their fonts; an SVG has its size in mm, and text as text. Throws OutputError where a
/// file cannot be written or is cut short.
AddedFigures addFigures(const std::vector<PrintFigure>& figures, const FigureStyle& style,
                        FileSet& files);

}  // namespace hshfit::inline pages
