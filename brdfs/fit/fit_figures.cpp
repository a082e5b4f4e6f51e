#include <brdfs/catalog/tables.h>
#include <brdfs/fit/distributions.h>
#include <brdfs/fit/fit_figures.h>
#include <brdfs/fit/residual_rows.h>
#include <brdfs/fit/split_models.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/pages/gnuplot.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace hshfit::brdfs {
namespace {

using Kind = PrintSeries::Kind;

const std::string unitOfF = "f_r (sr^{−1})";

/// f of the drawn channels, then of each term, at angles of one cut.
class Curves {
public:
    Curves(const PlottedModel& model, const SampleCuts& cuts, const SampleCut& cut,
           const std::vector<std::size_t>& drawn)
        : model_(model), cuts_(cuts), cut_(cut), drawn_(drawn) {
        const double peak = cut.theta;
        std::vector<double> angles;
        for (double angle = -89; angle <= 89; angle += 2) angles.push_back(angle);
        // A lobe may be narrower than these steps; it stands at the mirror direction or opposite.
        for (const double centre : {-peak, peak})
            for (const double off : {-1.0, -0.3, -0.1, 0.0, 0.1, 0.3, 1.0})
                if (std::abs(centre + off) < 89.5) angles.push_back(centre + off);
        angles.insert(angles.end(), {-89.9, 89.9});
        if (cuts.of == SampleCuts::Of::retro)
            std::erase_if(angles, [](double angle) { return angle < 0; });
        std::ranges::sort(angles);
        angles.erase(std::unique(angles.begin(), angles.end()), angles.end());
        append(angles.front(), valuesAt(angles.front()));
        for (std::size_t k = 1; k < angles.size(); ++k) {
            const double from = angles_.back(), to = angles[k];
            const std::vector<double> first = last_, end = valuesAt(to);
            refine(from, first, to, end, 0);
            append(to, end);
        }
    }

    const std::vector<double>& angles() const { return angles_; }
    const std::vector<double>& of(std::size_t curve) const { return values_[curve]; }

private:
    std::vector<double> valuesAt(double angle) const {
        const DirectionPair pair = cuts_.pairAt(cut_, angle);
        std::vector<double> values;
        const std::vector<double> all = evaluate(model_.brdf, pair.wi, pair.wo);
        for (const std::size_t c : drawn_) values.push_back(all[all.size() == 1 ? 0 : c]);
        for (const NamedBrdf& term : model_.terms)
            values.push_back(evaluate(*term.brdf, pair.wi, pair.wo).front());
        return values;
    }
    void append(double angle, const std::vector<double>& values) {
        values_.resize(values.size());
        angles_.push_back(angle);
        for (std::size_t i = 0; i < values.size(); ++i) values_[i].push_back(values[i]);
        last_ = values;
    }
    void refine(double from, const std::vector<double>& first, double to,
                const std::vector<double>& end, int depth) {
        constexpr int deepest = 7;
        constexpr double tolerance = 0.005;
        const double middle = (from + to) / 2;
        const std::vector<double> values = valuesAt(middle);
        bool straight = true;
        for (std::size_t i = 0; i < values.size(); ++i)
            straight = straight && !(std::abs(values[i] - (first[i] + end[i]) / 2) >
                                     tolerance * std::abs(values[i]));
        if (straight || depth == deepest) return;
        refine(from, first, middle, values, depth + 1);
        append(middle, values);
        refine(middle, values, to, end, depth + 1);
    }

    const PlottedModel& model_;
    const SampleCuts& cuts_;
    const SampleCut& cut_;
    const std::vector<std::size_t>& drawn_;
    std::vector<double> angles_, last_;
    std::vector<std::vector<double>> values_;
};

std::string titleOf(const SampleCuts& cuts, const SampleCut& cut, bool isotropic) {
    if (cuts.of == SampleCuts::Of::retro) return "θ_i = θ_o";
    const std::string fixed = cuts.of == SampleCuts::Of::incidence ? "i" : "o";
    std::string title = fmt::format("θ_{} = {:.3g}°", fixed, cut.theta);
    if (!isotropic) title += fmt::format(", φ_{} = {:.3g}°", fixed, cut.azimuth);
    return title;
}

class CutFigures {
public:
    CutFigures(const PlottedModel& model, const SampleCuts& cuts, const FigureStyle& style)
        : model_(model),
          cuts_(cuts),
          drawn_(drawnChannels(model.samples.channels)),
          names_(model.samples.channels.names()) {
        for (const SampleCut& cut : cuts.cuts) panels_.push_back(panelOf(cut));
        const PrintAxis axis = axisOf(values_, style.axis, unitOfF);
        for (PrintPanel& panel : panels_) panel.y = axis;
    }

    PrintFigure figure(PrintFigure::Kind kind) const {
        const bool polar = kind == PrintFigure::Kind::polar;
        PrintFigure figure{.name = polar ? "polar" : "cuts",
                           .kind = kind,
                           .columns = {movingName(), "f"},
                           .panels = panels_};
        if (polar)
            for (std::size_t k = 0; k < panels_.size(); ++k)
                figure.panels[k].x = {.low = 0, .high = cuts_.cuts[k].theta};
        return figure;
    }

private:
    std::string movingName() const {
        return cuts_.of == SampleCuts::Of::incidence ? "theta_o" : "theta_i";
    }

    PrintPanel panelOf(const SampleCut& cut) {
        const bool retro = cuts_.of == SampleCuts::Of::retro;
        PrintPanel panel{.title = titleOf(cuts_, cut, model_.samples.isotropic)};
        panel.x = linearAxis(retro ? 0 : -90, 90,
                             cuts_.of == SampleCuts::Of::incidence ? "θ_o (°)" : "θ_i (°)");
        panel.x.ticks = {{0, "0"}, {30, "", true}, {60, "60"}, {90, "", true}};
        if (!retro)
            panel.x.ticks.insert(panel.x.ticks.begin(),
                                 {{-90, "", true}, {-60, "−60"}, {-30, "", true}});
        const Curves curves(model_, cuts_, cut, drawn_);
        addBands(curves, cut, panel);
        const bool single = drawn_.size() == 1;
        for (std::size_t t = 0; t < model_.terms.size(); ++t)
            panel.series.push_back({.label = model_.terms[t].name,
                                    .ink = 1 + t % 2,
                                    .dash = 1 + t % 3,
                                    .x = curves.angles(),
                                    .y = curves.of(drawn_.size() + t)});
        const std::vector<double> readings = readingsOf(curves, cut);
        for (std::size_t i = 0; i < drawn_.size(); ++i) {
            PrintSeries own{.label = single ? model_.name : channelName(i),
                            .ink = inkOf(i),
                            .dash = i,
                            .x = curves.angles(),
                            .y = curves.of(i)};
            if (model_.readings) {
                addValues(own);
                panel.series.push_back({.label = fmt::format("f of the {}", model_.name),
                                        .ink = inkOf(i),
                                        .dash = 3,
                                        .width = 0.6,
                                        .x = own.x,
                                        .y = own.y});
                const auto first = readings.begin() +
                                   static_cast<std::ptrdiff_t>(drawn_[i] * curves.angles().size());
                own.y.assign(first, first + static_cast<std::ptrdiff_t>(curves.angles().size()));
                if (single) own.label += " as the instrument reads it";
            }
            panel.series.push_back(std::move(own));
            addValues(panel.series.back());
        }
        for (std::size_t i = 0; i < drawn_.size(); ++i) {
            panel.series.push_back(pointsOf(cut, drawn_[i]));
            PrintSeries& points = panel.series.back();
            points.label = single ? "measured" : channelName(i);
            points.ink = single ? 3 : inkOf(i);
            points.marker = i;
        }
        return panel;
    }

    std::size_t inkOf(std::size_t i) const { return channelInk(model_.samples.channels.kind, i); }

    std::string channelName(std::size_t i) const {
        return fmt::format("{}, measured and {}", names_[drawn_[i]], model_.name);
    }

    /// Values of curves that the axis has to hold: f may grow without limit towards the horizon.
    void addValues(const PrintSeries& curve) {
        constexpr double steepest = 85;
        for (std::size_t k = 0; k < curve.x.size(); ++k)
            if (std::abs(curve.x[k]) <= steepest) values_.push_back(curve.y[k]);
    }

    std::vector<DirectionPair> pairsOf(const Curves& curves, const SampleCut& cut) const {
        std::vector<DirectionPair> pairs;
        for (const double angle : curves.angles()) pairs.push_back(cuts_.pairAt(cut, angle));
        return pairs;
    }
    std::vector<double> readingsOf(const Curves& curves, const SampleCut& cut) const {
        if (!model_.readings) return {};
        return model_.readings(pairsOf(curves, cut));
    }

    void addBands(const Curves& curves, const SampleCut& cut, PrintPanel& panel) const {
        if (!model_.band) return;
        const std::vector<DirectionPair> pairs = pairsOf(curves, cut);
        const std::vector<double> widths = model_.band(pairs);
        for (std::size_t i = 0; i < drawn_.size(); ++i) {
            PrintSeries band{.kind = Kind::band, .label = model_.bandName, .x = curves.angles()};
            band.y = curves.of(i);
            for (std::size_t k = 0; k < pairs.size(); ++k) {
                const double width = widths[drawn_[i] * pairs.size() + k];
                band.low.push_back(band.y[k] - width);
                band.high.push_back(band.y[k] + width);
            }
            panel.series.push_back(std::move(band));
        }
    }

    PrintSeries pointsOf(const SampleCut& cut, std::size_t channel) {
        PrintSeries points{.kind = Kind::points, .x = cut.angles};
        const FitSamples& samples = model_.samples;
        for (const std::size_t k : cut.samples) {
            const double value = samples.value(channel, k);
            points.y.push_back(value);
            values_.push_back(value);
            if (samples.sigmas.empty()) continue;
            const double sigma = samples.sigmas[channel * samples.size() + k];
            points.low.push_back(value - sigma);
            points.high.push_back(value + sigma);
            values_.push_back(value + sigma);
        }
        return points;
    }

    const PlottedModel& model_;
    const SampleCuts& cuts_;
    std::vector<std::size_t> drawn_;
    std::vector<std::string> names_;
    std::vector<double> values_;
    std::vector<PrintPanel> panels_;
};

/// The value of a standard normal variable that a share of its values is below.
double normalQuantile(double share) {
    const double size =
        studentBound(2 * std::min(share, 1 - share), std::numeric_limits<double>::infinity());
    return share < 0.5 ? -size : size;
}

PrintSeries guide(double fromX, double fromY, double toX, double toY, std::size_t dash) {
    return {.kind = Kind::guide, .dash = dash, .x = {fromX, toX}, .y = {fromY, toY}};
}

PrintFigure residualFigure(const PlottedModel& model) {
    constexpr std::size_t mostMarkers = 3000;
    const FitSamples& samples = model.samples;
    const std::size_t count = samples.size();
    const auto drawn = drawnChannels(samples.channels);
    const auto names = samples.channels.names();
    PrintFigure figure{
        .name = "residuals", .shared = false, .columns = {"x", "standardised_residual"}};
    const std::array<std::string, 4> titles{"θ_i (°)", "θ_o (°)", "aspecular angle (°)",
                                            "normal quantile"};
    for (const std::string& title : titles) figure.panels.push_back({.x = {.label = title}});
    const std::size_t step = (count + mostMarkers - 1) / mostMarkers;
    double most = 3, widest = 0;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        const double* own = &model.residuals[drawn[i] * count];
        std::array<PrintSeries, 4> series;
        std::vector<double> sorted(own, own + count);
        std::ranges::sort(sorted);
        most = std::max({most, -sorted.front(), sorted.back()});
        for (std::size_t k = 0; k < count; k += step) {
            const Direction wi{samples.wiX[k], samples.wiY[k], samples.wiZ[k]};
            const std::array<double, 3> angles{degrees(polarAngle(wi)),
                                               degrees(polarAngle(samples.wo[k])),
                                               aspecularAngle(samples, k)};
            for (std::size_t p = 0; p < 3; ++p) {
                series[p].x.push_back(angles[p]);
                series[p].y.push_back(own[k]);
            }
            const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
            series[3].x.push_back(normalQuantile(share));
            series[3].y.push_back(sorted[k]);
        }
        widest = std::max(widest, std::abs(series[3].x.front()));
        for (std::size_t p = 0; p < 4; ++p) {
            series[p].kind = Kind::points;
            series[p].label = drawn.size() > 1 ? names[drawn[i]] : "";
            series[p].ink = channelInk(samples.channels.kind, i);
            series[p].marker = i;
            figure.panels[p].series.push_back(std::move(series[p]));
        }
    }
    const double end = roundedUp(1.02 * most), side = std::ceil(2 * widest + 0.2) / 2;
    for (std::size_t p = 0; p < 4; ++p) {
        PrintPanel& panel = figure.panels[p];
        const std::string label = panel.x.label;
        panel.x =
            p == 3 ? linearAxis(-side, side, label) : linearAxis(0, p == 2 ? 180 : 90, label, 4);
        if (p != 3)
            panel.x.ticks =
                p == 2 ? std::vector<AxisTick>{{0, "0"}, {60, "60"}, {120, "120"}, {180, "180"}}
                       : std::vector<AxisTick>{{0, "0"}, {30, "30"}, {60, "60"}, {90, "90"}};
        panel.y = linearAxis(-end, end, p % 2 == 0 ? "standardised residual" : "", 6);
        const double low = panel.x.low, high = panel.x.high;
        const std::vector<PrintSeries> guides =
            p == 3 ? std::vector{guide(-side, -side, side, side, 0)}
                   : std::vector{guide(low, 0, high, 0, 0), guide(low, -2, high, -2, 1),
                                 guide(low, 2, high, 2, 1)};
        panel.series.insert(panel.series.begin(), guides.begin(), guides.end());
    }
    return figure;
}

}  // namespace

std::vector<NamedBrdf> termsOf(const FitResult& result) {
    if (result.spectrum.size() > 1) return {};
    const std::string& spec = result.spectrum.empty() ? result.spec : result.spectrum[0].spec;
    std::vector<NamedBrdf> terms;
    const std::vector<std::string> parts = splitModels(spec), names = termNames(spec);
    for (std::size_t t = 0; t < parts.size(); ++t) {
        terms.push_back({names[t], openModels(parts[t])});
        if (terms.back().brdf->channels().count() > 1) return {};
    }
    if (terms.size() < 2) terms.clear();
    return terms;
}

std::vector<PrintFigure> sampleFigures(const PlottedModel& model, const SampleCuts& cuts,
                                       const FigureStyle& style) {
    std::vector<PrintFigure> figures;
    if (!cuts.cuts.empty()) {
        const CutFigures own(model, cuts, style);
        figures.push_back(own.figure(PrintFigure::Kind::axes));
        if (cuts.of != SampleCuts::Of::retro)
            figures.push_back(own.figure(PrintFigure::Kind::polar));
    }
    if (!model.residuals.empty()) figures.push_back(residualFigure(model));
    return figures;
}

std::optional<PrintFigure> spectrumFigure(const FitResult& result, const Channels& channels) {
    if (channels.kind != Channels::Kind::spectral || channels.count() < 2) return std::nullopt;
    std::map<std::string, double> wavelengths;
    const auto names = channels.names();
    for (std::size_t c = 0; c < names.size(); ++c) wavelengths[names[c]] = channels.wavelengths[c];
    PrintFigure figure{.name = "spectrum", .shared = false, .columns = {"wavelength", "value"}};
    const double first = channels.wavelengths.front(), last = channels.wavelengths.back();
    const double edge = 0.02 * (last - first);
    for (const FittedParameter& p : result.parameters) {
        const auto at = wavelengths.find(p.channel);
        if (at == wavelengths.end()) continue;
        const std::string title = unenhanced(p.name);
        auto panel = std::ranges::find(figure.panels, title, &PrintPanel::title);
        if (panel == figure.panels.end()) {
            figure.panels.push_back(
                {.title = title, .x = linearAxis(first - edge, last + edge, "wavelength (nm)", 4)});
            panel = figure.panels.end() - 1;
            panel->series = {{.kind = Kind::line}, {.kind = Kind::points, .ink = 3}};
        }
        const double error = p.standardError.value_or(0);
        for (PrintSeries& series : panel->series) {
            series.x.push_back(at->second);
            series.y.push_back(p.value);
        }
        panel->series[1].low.push_back(p.value - error);
        panel->series[1].high.push_back(p.value + error);
    }
    for (PrintPanel& panel : figure.panels) {
        std::vector<double> values = panel.series[1].high;
        // An error that is larger than the values would hide them.
        const double most = std::ranges::max(panel.series[1].y);
        if (most > 0)
            for (double& value : values) value = std::min(value, 2 * most);
        panel.y = axisOf(values, FigureAxis::linear, "");
    }
    if (figure.panels.empty()) return std::nullopt;
    return figure;
}

}  // namespace hshfit::brdfs
