// Figures for print: colours, axes, and the files that gnuplot draws.

#include <hshfit/error.h>
#include <hshfit/pages/internal/print_layout.h>
#include <hshfit/pages/print_figure.h>

#include "lib/coefficient_files/coefficient_samples.h"
#include "places.h"

#include <gtest/gtest.h>
#include <pugixml.hpp>

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <regex>

using namespace hshfit;
using samples::contentOf;
using samples::Folder;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

using Rgb = std::array<double, 3>;

/// Linear Rec. 709 of "#rrggbb" (IEC 61966-2-1).
Rgb linearOf(std::string_view ink) {
    Rgb result{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double v = std::stoi(std::string(ink.substr(1 + 2 * c, 2)), nullptr, 16) / 255.0;
        result[c] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
    return result;
}

/// CIE 1976 L*.
double lightnessOf(const Rgb& c) {
    const double y = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : 24389.0 / 27 * y;
}

// The matrices of Machado, Oliveira & Fernandes 2009 (10.1109/TVCG.2009.113) for readers without
// L, M or S cones, in linear RGB.
constexpr std::array<std::array<double, 9>, 3> dichromats{
    {{0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998},
     {0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881},
     {1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367,
      0.303900}}};

Rgb seenWith(const std::array<double, 9>& m, const Rgb& c) {
    Rgb out{};
    for (std::size_t row = 0; row < 3; ++row)
        out[row] =
            std::clamp(m[3 * row] * c[0] + m[3 * row + 1] * c[1] + m[3 * row + 2] * c[2], 0.0, 1.0);
    return out;
}

TEST(FigureStyle, InksDifferInLightnessForAllReaders) {
    const auto inks = figureInks();
    for (std::size_t a = 0; a < inks.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) {
            const Rgb x = linearOf(inks[a]), y = linearOf(inks[b]);
            // In greyscale a fifth of the range from black to white.
            EXPECT_GT(std::abs(lightnessOf(x) - lightnessOf(y)), 20) << inks[a] << " " << inks[b];
            for (const auto& matrix : dichromats)
                EXPECT_GT(
                    std::abs(lightnessOf(seenWith(matrix, x)) - lightnessOf(seenWith(matrix, y))),
                    10)
                    << inks[a] << " " << inks[b];
        }
}

TEST(FigureStyle, WidthsHaveUnitsOrNames) {
    EXPECT_EQ(parseFigureWidth("column"), 84);
    EXPECT_EQ(parseFigureWidth("page"), 174);
    EXPECT_EQ(parseFigureWidth("90mm"), 90);
    EXPECT_DOUBLE_EQ(parseFigureWidth("3.5in"), 88.9);
    EXPECT_DOUBLE_EQ(parseFigureWidth("8.4 cm"), 84);
    EXPECT_DOUBLE_EQ(parseFigureWidth("72pt"), 25.4);
    EXPECT_EQ(parseFontSize("8"), 8);
    EXPECT_EQ(parseFontSize("7.5pt"), 7.5);
}

TEST(FigureStyle, SenselessValuesAreRefused) {
    for (const char* width : {"0", "0mm", "-84mm", "84", "84km", "", "nanmm", "infmm", "1e9mm"})
        EXPECT_THROW(parseFigureWidth(width), UsageError) << width;
    for (const char* size : {"", "0", "-8", "large", "8px", "nan", "1e3"})
        EXPECT_THROW(parseFontSize(size), UsageError) << size;
    for (const char* font : {" ", "a,b", "Times'", "Times\"", "a\nb", "{x}"})
        EXPECT_THROW(checkFigureStyle({.font = font}), UsageError) << font;
    EXPECT_NO_THROW(checkFigureStyle({.font = "Liberation Sans"}));
    EXPECT_THROW(findFigureAxis("logarithmic"), UsageError);
}

TEST(PrintAxis, HoldsItsValuesWithin6Decades) {
    const PrintAxis log = axisOf({0.003, -1, 0, none, 40}, FigureAxis::automatic, "f");
    EXPECT_EQ(log.scale, PrintAxis::Scale::logarithmic);
    EXPECT_DOUBLE_EQ(log.low, 1e-3);
    EXPECT_DOUBLE_EQ(log.high, 100);
    const PrintAxis deep = axisOf({1e-20, 1}, FigureAxis::automatic, "f");
    EXPECT_DOUBLE_EQ(deep.low, 1e-6);
    EXPECT_DOUBLE_EQ(deep.high, 1);
    const PrintAxis linear = axisOf({0.1, 2.9}, FigureAxis::automatic, "f");
    EXPECT_EQ(linear.scale, PrintAxis::Scale::linear);
    EXPECT_EQ(linear.low, 0);
    EXPECT_EQ(linear.high, 3);
    EXPECT_EQ(axisOf({0.1, 2}, FigureAxis::logarithmic, "f").scale, PrintAxis::Scale::logarithmic);
    for (const std::vector<double>& values :
         {std::vector<double>{}, {none}, {0, 0}, {-3, -1}, {HUGE_VAL}}) {
        const PrintAxis axis = axisOf(values, FigureAxis::logarithmic, "f");
        EXPECT_LT(axis.low, axis.high);
        EXPECT_FALSE(axis.ticks.empty());
    }
}

TEST(PrintAxis, TicksAreRoundNumbersWithinTheAxis) {
    for (const auto& [low, high] :
         {std::pair{0.0, 1.0}, {-3.2, 3.2}, {0.0, 1.6e-7}, {380.0, 730.0}, {-1e9, 1e12}})
        for (const int most : {2, 4, 6}) {
            const auto ticks = linearTicks(low, high, most);
            ASSERT_GE(ticks.size(), 1u);
            EXPECT_LE(ticks.size(), static_cast<std::size_t>(most) + 1);
            for (const AxisTick& tick : ticks) {
                EXPECT_GE(tick.at, low - 1e-6 * (high - low));
                EXPECT_LE(tick.at, high + 1e-6 * (high - low));
            }
        }
    EXPECT_EQ(linearTicks(-1, 1, 4).front().label, "−1");
    EXPECT_EQ(logTicks(-5, 1, 4).back().label, "10^{1}");
}

/// A panel on a logarithmic axis with values that have no place on it, and one whose axis is
/// linear.
PrintFigure figureOf(PrintFigure::Kind kind) {
    PrintFigure figure{.name = kind == PrintFigure::Kind::polar ? "polar" : "figure",
                       .kind = kind,
                       .shared = false};
    for (const bool logarithmic : {true, false}) {
        PrintPanel panel{.title = "θ_i = 30°"};
        panel.x = linearAxis(-90, 90, "θ_o (°)");
        if (kind == PrintFigure::Kind::polar) panel.x = {.low = 0, .high = 30};
        panel.y = axisOf({0.001, 10, -3},
                         logarithmic ? FigureAxis::logarithmic : FigureAxis::linear, "f");
        panel.series = {
            {.kind = PrintSeries::Kind::band, .label = "95 %"},
            {.label = "fit"},
            {.kind = PrintSeries::Kind::points, .label = "measured, \"'`a_b^{c}\\ é", .ink = 3}};
        for (int angle = -80; angle <= 80; angle += 20) {
            const double f = angle == 0 ? 0 : angle == 20 ? -3 : angle == 40 ? none : 0.05;
            for (PrintSeries& series : panel.series) {
                series.x.push_back(angle);
                series.y.push_back(f);
                if (&series == &panel.series[1]) continue;
                series.low.push_back(f - 0.1);
                series.high.push_back(f + 0.1);
            }
        }
        figure.panels.push_back(panel);
    }
    return figure;
}

constexpr int markers = 2 * 8;  ///< of figureOf: one value of nine is none

struct SvgFacts {
    int markers = 0;
    double width = 0, height = 0, farthest = 0;  ///< farthest: beyond the edges, in points
};

/// The drawn markers and how far paths reach beyond the page.
SvgFacts factsOf(const std::string& path) {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_file(path.c_str())) << path;
    const pugi::xml_node root = document.child("svg");
    SvgFacts facts;
    double left = 0, top = 0;
    std::sscanf(root.attribute("viewBox").value(), "%lf %lf %lf %lf", &left, &top, &facts.width,
                &facts.height);
    const std::regex point("[ML]([-0-9.e]+),([-0-9.e]+)");
    const std::function<void(const pugi::xml_node&)> visit = [&](const pugi::xml_node& node) {
        const std::string name = node.name();
        if (name == "defs") return;
        if (name == "use") ++facts.markers;
        if (name == "path") {
            const std::string d = node.attribute("d").value();
            for (std::sregex_iterator at(d.begin(), d.end(), point), end; at != end; ++at) {
                const double x = std::stod((*at)[1]), y = std::stod((*at)[2]);
                facts.farthest =
                    std::max({facts.farthest, -x, x - facts.width, -y, y - facts.height});
            }
        }
        for (const pugi::xml_node& child : node.children()) visit(child);
    };
    visit(root);
    return facts;
}

std::size_t countOf(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
    return count;
}

class PrintedFigures : public testing::Test {
protected:
    void SetUp() override {
        if (!test::hasGnuplot()) GTEST_SKIP() << test::noGnuplot;
    }

    AddedFigures draw(const std::vector<PrintFigure>& figures, const FigureStyle& style,
                      const std::string& name) {
        FileSet files(folder_ / name, true);
        AddedFigures added = addFigures(figures, style, files);
        EXPECT_FALSE(added.undrawn) << *added.undrawn;
        files.commit();
        return added;
    }

    Folder folder_;
};

TEST_F(PrintedFigures, HaveAMarkerForEachValueAndNoSpikes) {
    for (const auto kind : {PrintFigure::Kind::axes, PrintFigure::Kind::polar}) {
        const PrintFigure figure = figureOf(kind);
        draw({figure}, {}, "a");
        const SvgFacts facts = factsOf(folder_ / ("a/" + figure.name + ".svg"));
        EXPECT_EQ(facts.markers, markers + 1) << "and one in the legend";
        EXPECT_LE(facts.farthest, 0.5);
    }
}

/// Two rows of two panels with own axes; the legend is wider than a column.
TEST(PrintFigure, ColumnsCanBeShownApart) {
    PrintSeries series{.label = {}, .x = {0, 1}, .y = {0, 1}};
    PrintPanel panel{.x = linearAxis(0, 1, "x"), .y = linearAxis(0, 1, "y")};
    for (const char* more : {"one", "two", "three", "four"}) {
        series.label = std::string("a name in the legend, ") + more;
        panel.series.push_back(series);
    }
    const PrintFigure own{.shared = false, .panels = {panel, panel, panel, panel}};
    const FigureStyle page{.width = 174};
    const double points = 174 * 72 / 25.4;
    const std::vector<int> columns = figureColumns(own, page);
    ASSERT_EQ(columns.size(), 2u);
    EXPECT_EQ(columns[0], 0);
    EXPECT_NEAR(columns[1], points / 2, 0.05 * points);
    // Panels with shared axes have their labels at the margins: they stay together.
    const PrintFigure shared{.shared = true, .panels = own.panels};
    EXPECT_TRUE(figureColumns(shared, page).empty());
    // The legend is within the first column.
    const std::vector<LegendItem> legend = layoutOf(own, page).legend;
    ASSERT_EQ(legend.size(), 4u);
    for (const LegendItem& item : legend)
        EXPECT_LT(item.x + page.fontSize * (legendSample + textWidth(item.label)), columns[1]);
}

TEST_F(PrintedFigures, HaveTheWidthThatIsAskedFor) {
    for (const double width : {50.0, 84.0, 174.0}) {
        const FigureStyle style{.width = width};
        const PrintFigure figure = figureOf(PrintFigure::Kind::axes);
        draw({figure}, style, "a");
        const std::string svg = contentOf(folder_ / "a/figure.svg");
        EXPECT_NE(svg.find("width=\"" + std::to_string(static_cast<int>(width)) + "mm\""),
                  svg.npos);
        std::smatch box;
        const std::string pdf = contentOf(folder_ / "a/figure.pdf");
        ASSERT_TRUE(
            std::regex_search(pdf, box, std::regex(R"(/MediaBox \[ 0 0 ([0-9.]+) ([0-9.]+) \])")));
        // gnuplot rounds down to points.
        EXPECT_NEAR(std::stod(box[1]), width / 25.4 * 72, 1.01);
        EXPECT_NEAR(std::stod(box[2]), figureSize(figure, style)[1] / 25.4 * 72, 1.01);
    }
}

TEST_F(PrintedFigures, EmbedEveryFontAndKeepTextAsText) {
    draw({figureOf(PrintFigure::Kind::axes)}, {}, "a");
    const std::string pdf = contentOf(folder_ / "a/figure.pdf");
    const std::size_t fonts = countOf(pdf, "/Type /FontDescriptor");
    EXPECT_GE(fonts, 1u);
    EXPECT_EQ(countOf(pdf, "/FontFile"), fonts);
    EXPECT_EQ(countOf(pdf, "/Subtype /Image"), 0u);
    EXPECT_NE(contentOf(folder_ / "a/figure.svg").find("measured"), std::string::npos);
}

TEST_F(PrintedFigures, NameTheFontThatStandsInForAnother) {
    const std::vector figures{figureOf(PrintFigure::Kind::axes)};
    EXPECT_EQ(draw(figures, {}, "a").font, "");
    EXPECT_NE(draw(figures, {.font = "No Such Font 7"}, "b").font, "");
}

TEST_F(PrintedFigures, AreDrawnAgainByTheirScript) {
    draw({figureOf(PrintFigure::Kind::axes), figureOf(PrintFigure::Kind::polar)}, {}, "a");
    std::filesystem::remove(folder_ / "a/figure.pdf");
    ASSERT_EQ(std::system(("cd '" + (folder_ / "a") + "' && gnuplot figures.gp").c_str()), 0);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a/figure.pdf"));
}

TEST_F(PrintedFigures, GoToFoldersOfAnyName) {
    for (const std::string name : {"''", "\"b\"", "`c`", "d\\e", "é %_^{x}$&#~", "g\nh"}) {
        draw({figureOf(PrintFigure::Kind::axes)}, {}, name);
        EXPECT_GT(factsOf((folder_ / name) + "/figure.svg").markers, 0) << name;
    }
}

}  // namespace
