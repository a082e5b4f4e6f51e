#include <hshfit/pages/comparison_print.h>
#include <hshfit/pages/internal/comparison_files.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace hshfit::inline pages {
namespace {

using Curve = ComparisonCurve;

/// Values of both sides, at angles up to `steepest`.
std::vector<double> valuesOf(const std::vector<const Curve*>& curves, double steepest) {
    std::vector<double> values;
    for (const Curve* curve : curves)
        for (const auto* side : {&curve->reference, &curve->approximation})
            for (const auto& channel : *side)
                for (std::size_t i = 0; i < channel.size(); ++i)
                    if (std::abs(curve->angles[i]) <= steepest) values.push_back(channel[i]);
    return values;
}

class Printer {
public:
    Printer(const Comparison& comparison, const FigureStyle& style)
        : comparison_(comparison), style_(style) {}

    std::vector<PrintFigure> figures() const {
        std::vector<PrintFigure> figures;
        for (const ResidualMap& map : comparison_.residuals) {
            const std::string end = fmt::format("-{}", map.azimuth);
            figures.push_back(curves("polar" + end, comparison_.polar, map.azimuth));
            figures.push_back(curves("half" + end, comparison_.half, map.azimuth));
            figures.push_back(curves("albedo" + end, comparison_.albedo, map.azimuth));
            figures.push_back(residual("residual" + end, map));
        }
        return figures;
    }

private:
    /// Series of both sides. The approximation is dashed; where both have one channel, it has
    /// another colour.
    std::vector<PrintSeries> seriesOf(const Curve& curve) const {
        const auto names = comparison_.channels.names();
        const std::size_t count = comparison_.drawn.size();
        std::vector<PrintSeries> series;
        for (const bool own : {false, true})
            for (std::size_t c = 0; c < count; ++c) {
                const std::string channel =
                    count > 1 ? ", " + names[comparison_.drawn[c]] : std::string();
                series.push_back({.label = (own ? "approximation" : "reference") + channel,
                                  .ink = count > 1 ? channelInk(comparison_.channels.kind, c)
                                         : own     ? 1U
                                                   : 0U,
                                  .dash = own ? 1U : 0U,
                                  .width = own ? 1.0 : 1.4,
                                  .x = curve.angles,
                                  .y = own ? curve.approximation[c] : curve.reference[c]});
            }
        return series;
    }

    PrintFigure curves(const std::string& name, const std::vector<Curve>& all,
                       double azimuth) const {
        const bool polar = &all == &comparison_.polar, half = &all == &comparison_.half;
        PrintFigure figure{.name = name,
                           .kind = polar ? PrintFigure::Kind::polar : PrintFigure::Kind::axes,
                           .columns = {polar  ? "theta_i"
                                       : half ? "theta_h"
                                              : "theta_o",
                                       polar || half ? "f" : "albedo"}};
        std::vector<const Curve*> drawn;
        for (const Curve& curve : all)
            if (curve.azimuth == azimuth) drawn.push_back(&curve);
        constexpr double steepest = 85;  // f may grow without limit towards the horizon
        const PrintAxis y =
            axisOf(valuesOf(drawn, steepest), polar || half ? style_.axis : FigureAxis::linear,
                   polar || half ? "f_r (sr^{−1})" : "directional albedo");
        for (const Curve* curve : drawn) {
            PrintPanel panel{.title = polar  ? fmt::format("θ_o = {:g}°", curve->slice)
                                      : half ? fmt::format("θ_d = {:g}°", curve->slice)
                                             : "",
                             .x = polar  ? PrintAxis{.low = 0, .high = curve->slice}
                                  : half ? rootAxis()
                                         : linearAxis(0, 90, "θ_o (°)", 4),
                             .y = y,
                             .series = seriesOf(*curve)};
            if (!polar && !half) panel.x.ticks = {{0, "0"}, {30, "30"}, {60, "60"}, {90, "90"}};
            figure.panels.push_back(std::move(panel));
        }
        return figure;
    }

    static PrintAxis rootAxis() {
        PrintAxis axis{"θ_h (°)", 0, 90, PrintAxis::Scale::root, {}};
        for (const int angle : {0, 5, 20, 45, 90})
            axis.ticks.push_back({static_cast<double>(angle), fmt::format("{}", angle)});
        return axis;
    }

    PrintFigure residual(const std::string& name, const ResidualMap& map) const {
        PrintFigure figure{
            .name = name, .kind = PrintFigure::Kind::map, .columns = {"theta_h", "theta_d"}};
        PrintPanel panel{.title = "log_{10}(approximation / reference)",
                         .x = rootAxis(),
                         .y = linearAxis(0, 90, "θ_d (°)")};
        panel.y.ticks = {{0, "0"}, {30, "30"}, {60, "60"}, {90, "90"}};
        const double end = std::log10(largestRatio(comparison_));
        panel.colours = linearAxis(-end, end, "", 4);
        PrintSeries cells;
        const std::size_t width = map.thetaHalf.size();
        for (std::size_t cell = 0; cell < map.logRatio.size(); ++cell) {
            cells.x.push_back(map.thetaHalf[cell % width]);
            cells.y.push_back(map.thetaDifference[cell / width]);
            cells.low.push_back(map.measured[cell] ? map.logRatio[cell] : NAN);
        }
        panel.series.push_back(std::move(cells));
        figure.panels.push_back(std::move(panel));
        return figure;
    }

    const Comparison& comparison_;
    const FigureStyle& style_;
};

}  // namespace

std::vector<PrintFigure> printFigures(const Comparison& comparison, const FigureStyle& style) {
    return Printer(comparison, style).figures();
}

}  // namespace hshfit::inline pages
