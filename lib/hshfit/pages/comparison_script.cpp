#include <hshfit/files/template_text.h>
#include <hshfit/pages/axis_ticks.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/internal/comparison_files.h>
#include <hshfit/pages/report_files.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view comparison_gp;
}

namespace hshfit::inline pages {

namespace {

using kainjow::mustache::data;

/// A broad pale line for the reference under a thin dark one for the approximation, so that both
/// are seen where they agree. Colours after Okabe & Ito (2008) where there is no natural one.
struct Ink {
    const char *broad, *thin;
};

std::vector<Ink> inksOf(const Comparison& comparison) {
    const Ink blue{"#7DB4E6", "#1556A0"}, green{"#8CCB8F", "#1B7A34"}, red{"#F0998E", "#B3261E"},
        grey{"#A9B4C0", "#D55E00"}, purple{"#C9A3DB", "#6A2C91"};
    switch (comparison.channels.kind) {
        case Channels::Kind::grey:
            return {grey};
        case Channels::Kind::rgb:
            return {red, green, blue};
        case Channels::Kind::spectral:
        case Channels::Kind::named:
            break;
    }
    if (comparison.drawn.size() == 1) return {grey};
    return {blue, green, red, purple};
}

/// The least and greatest finite value above 0 of both, of angles up to `steepest` degrees.
std::array<double, 2> rangeOf(const ComparisonCurve& curve, double steepest) {
    double least = HUGE_VAL, most = 0;
    for (const auto* side : {&curve.reference, &curve.approximation}) {
        for (const auto& channel : *side) {
            for (std::size_t i = 0; i < channel.size(); ++i) {
                if (!(channel[i] > 0) || !std::isfinite(channel[i])) continue;
                if (std::abs(curve.angles[i]) > steepest) continue;
                least = std::min(least, channel[i]);
                most = std::max(most, channel[i]);
            }
        }
    }
    return most > 0 ? std::array{least, most} : std::array{0.1, 1.0};
}

data polarPanels(const Comparison& comparison) {
    data panels{data::type::list};
    for (std::size_t i = 0; i < comparison.polar.size(); ++i) {
        const ComparisonCurve& curve = comparison.polar[i];
        const auto [least, most] = rangeOf(curve, 85);
        const auto [low, high] = decadesOf(least, most, 5);
        data panel;
        panel.set("index", std::to_string(i + 1));
        panel.set("azimuth", fmt::format("{}", curve.azimuth));
        panel.set("slice", fmt::format("{}", curve.slice));
        panel.set("top", fmt::format("{:g}", roundedUp(most)));
        panel.set("low", std::to_string(low));
        panel.set("high", std::to_string(high));
        panels.push_back(panel);
    }
    return panels;
}

/// Sets the place of each curve in its file: rows from 0 without the header.
void setRows(data& fields, const std::string& file, const std::vector<ComparisonCurve>& curves) {
    data rows{data::type::list};
    std::size_t first = 0;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const std::size_t next = first + curves[i].angles.size();
        data row;
        row.set("index", std::to_string(i + 1));
        row.set("first", std::to_string(first));
        row.set("last", std::to_string(next - 1));
        rows.push_back(row);
        first = next;
    }
    fields.set(file + "Rows", rows);
    fields.set(file + "Count", std::to_string(curves.size()));
}

std::array<int, 2> halfDecades(const Comparison& comparison) {
    double least = HUGE_VAL, most = 0;
    for (const ComparisonCurve& curve : comparison.half) {
        const auto range = rangeOf(curve, 85);
        least = std::min(least, range[0]);
        most = std::max(most, range[1]);
    }
    return decadesOf(least, most, 8);
}

double albedoTop(const Comparison& comparison) {
    double most = 0;
    for (const ComparisonCurve& curve : comparison.albedo) {
        most = std::max(most, rangeOf(curve, 85)[1]);
    }
    return roundedUp(1.02 * most);
}

}  // namespace

double largestRatio(const Comparison& comparison) {
    const double most = std::pow(10, std::min(2.0, residualShares(comparison).most));
    for (const double ratio : {1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0}) {
        if (most <= ratio) return ratio;
    }
    return 100;
}

std::vector<ComparisonFigure> figuresOf(const Comparison& comparison) {
    std::vector<ComparisonFigure> figures;
    for (const ResidualMap& map : comparison.residuals) {
        for (const char* kind : {"polar", "half", "residual"}) {
            figures.push_back({kind, map.azimuth, fmt::format("{}-{}.svg", kind, map.azimuth)});
        }
    }
    return figures;
}

std::string comparisonScript(const Comparison& comparison) {
    data fields;
    data channels{data::type::list};
    const auto names = comparison.channels.names();
    const auto inks = inksOf(comparison);
    for (std::size_t i = 0; i < comparison.drawn.size(); ++i) {
        data channel;
        channel.set("index", std::to_string(i + 1));
        channel.set("name", comparison.channels.kind == Channels::Kind::grey
                                ? ""
                                : " " + names[comparison.drawn[i]]);
        channel.set("broad", inks[i].broad);
        channel.set("thin", inks[i].thin);
        channels.push_back(channel);
    }
    fields.set("channels", channels);
    fields.set("channelCount", std::to_string(comparison.drawn.size()));
    fields.set("panels", polarPanels(comparison));
    fields.set("panelCount", std::to_string(comparison.polar.size()));
    fields.set("slices", std::to_string(comparison.polar.size() / comparison.residuals.size()));
    setRows(fields, "polar", comparison.polar);
    setRows(fields, "half", comparison.half);
    setRows(fields, "albedo", comparison.albedo);
    const auto half = halfDecades(comparison);
    fields.set("halfLow", std::to_string(half[0]));
    fields.set("halfHigh", std::to_string(half[1]));
    fields.set("halfStep", half[1] - half[0] > 5 ? "100" : "10");
    fields.set("ratio", fmt::format("{:g}", largestRatio(comparison)));
    fields.set("cells", std::to_string(comparison.residuals.front().logRatio.size()));
    fields.set("albedoTop", fmt::format("{:g}", albedoTop(comparison)));
    data figures{data::type::list};
    const auto files = figuresOf(comparison);
    for (std::size_t i = 0; i < files.size(); ++i) {
        data figure;
        figure.set("index", std::to_string(i + 1));
        figure.set("place", std::to_string(i / 3));
        figure.set("file", files[i].file);
        figure.set("azimuth", fmt::format("{}", files[i].azimuth));
        figure.set(files[i].kind, true);
        figures.push_back(figure);
    }
    fields.set("figures", figures);
    return filledPage(embedded::comparison_gp, fields);
}

}  // namespace hshfit::inline pages
