#include <brdfs/fit/study_figures.h>
#include <hshfit/pages/gnuplot.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace hshfit::brdfs {
namespace {

using Kind = PrintSeries::Kind;

constexpr std::size_t mostMarkers = 3000;

/// The values in the order of their Cook's distances, largest first.
std::vector<std::size_t> mostInfluential(const std::vector<ValueInfluence>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto drawn =
        order.begin() + static_cast<std::ptrdiff_t>(std::min(order.size(), mostMarkers));
    std::ranges::partial_sort(order, drawn, std::ranges::greater(),
                              [&](std::size_t v) { return values[v].cook; });
    order.erase(drawn, order.end());
    return order;
}

PrintSeries level(double end, double at, std::size_t dash) {
    return {.kind = Kind::guide, .dash = dash, .x = {0, end}, .y = {at, at}};
}

}  // namespace

std::optional<PrintFigure> correlationFigure(const FitResult& result) {
    constexpr std::size_t mostLabels = 24;
    const std::size_t all = result.parameters.size();
    std::vector<std::size_t> own;
    for (std::size_t i = 0; i < all; ++i)
        if (!result.parameters[i].isScanScale()) own.push_back(i);
    if (own.size() < 2) return std::nullopt;
    const double edge = static_cast<double>(own.size()) + 0.5;
    // The first row stands on top.
    PrintPanel panel{.x = {.low = 0.5, .high = edge}, .y = {.low = edge, .high = 0.5}};
    panel.colours = linearAxis(-1, 1, "");
    PrintSeries map;
    const std::size_t step = (own.size() + mostLabels - 1) / mostLabels;
    for (std::size_t i = 0; i < own.size(); ++i) {
        const double row = static_cast<double>(i) + 1;
        const FittedParameter& p = result.parameters[own[i]];
        if (i % step == 0) {
            panel.x.ticks.push_back({row, fmt::format("{}", i + 1)});
            panel.y.ticks.push_back({row, unenhanced(fmt::format("{}  {}", p.label(), i + 1))});
        }
        for (std::size_t j = 0; j < own.size(); ++j) {
            map.x.push_back(static_cast<double>(j) + 1);
            map.y.push_back(row);
            map.low.push_back(result.correlations[own[i] * all + own[j]]);
        }
    }
    panel.series.push_back(std::move(map));
    return PrintFigure{.name = "correlations",
                       .kind = PrintFigure::Kind::map,
                       .columns = {"column", "row"},
                       .panels = {std::move(panel)}};
}

std::optional<PrintFigure> influenceFigure(const FitResult& result) {
    if (!result.uncertainty || result.uncertainty->values.empty()) return std::nullopt;
    const Uncertainty& study = *result.uncertainty;
    PrintSeries residuals{.kind = Kind::points}, distances{.kind = Kind::points};
    double leverage = 0, size = study.outlierBound, distance = 0;
    for (const std::size_t v : mostInfluential(study.values)) {
        const ValueInfluence& value = study.values[v];
        residuals.x.push_back(value.leverage);
        residuals.y.push_back(value.studentised);
        distances.x.push_back(static_cast<double>(v) + 1);
        distances.y.push_back(value.cook);
        leverage = std::max(leverage, value.leverage);
        distance = std::max(distance, value.cook);
        if (std::isfinite(value.studentised)) size = std::max(size, std::abs(value.studentised));
    }
    const double right = leverage > 0 ? roundedUp(1.02 * leverage) : 1, up = roundedUp(1.05 * size);
    const auto count = static_cast<double>(study.values.size());
    PrintFigure figure{.name = "influence", .shared = false, .columns = {"x", "value"}};
    figure.panels.push_back({.x = linearAxis(0, right, "leverage"),
                             .y = linearAxis(-up, up, "studentised residual", 6),
                             .series = {level(right, 0, 0), level(right, study.outlierBound, 1),
                                        level(right, -study.outlierBound, 1), residuals}});
    figure.panels.push_back(
        {.x = linearAxis(0, roundedUp(count), "number of the value", 4),
         .y = linearAxis(0, distance > 0 ? roundedUp(1.05 * distance) : 1, "Cook’s distance"),
         .series = {distances}});
    return figure;
}

}  // namespace hshfit::brdfs
