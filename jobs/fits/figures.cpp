#include "figures.h"

#include <hshfit/pages/comparison_print.h>

#include <brdfs/fit/budget_latex.h>
#include <brdfs/fit/fit_figures.h>
#include <brdfs/fit/instrument/instrument_fit.h>
#include <brdfs/fit/latex_table.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/fit/residual_rows.h>
#include <brdfs/fit/study_figures.h>

#include <iterator>
#include <memory>
#include <optional>
#include <utility>

namespace hshfit::jobs {
namespace {

/// The figures of measured samples, and how many of them stand in panels.
std::vector<PrintFigure> ofSamples(const brdfs::PlottedModel& model, const FigureOptions& options,
                                   FigureFiles& result) {
    brdfs::SampleCuts cuts = brdfs::cutsOf(model.samples);
    result.inPlane = cuts.inPlane;
    result.all = model.samples.size();
    cuts = brdfs::chosenCuts(std::move(cuts), options.panels);
    result.panels = cuts.cuts.size();
    for (const brdfs::SampleCut& cut : cuts.cuts) result.samples += cut.samples.size();
    return brdfs::sampleFigures(model, cuts, options.style);
}

/// Half widths of the band that holds the true f with 95 % at each pair.
std::vector<double> halfWidths(const brdfs::FitResult& result,
                               std::span<const DirectionPair> pairs) {
    brdfs::Prediction prediction = brdfs::predict(result, pairs, false);
    for (std::size_t v = 0; v < prediction.errors.size(); ++v)
        prediction.errors[v] *= brdfs::Prediction::pointwise(0.95, prediction.degrees[v]);
    return std::move(prediction.errors);
}

void append(std::vector<PrintFigure> more, std::vector<PrintFigure>& figures) {
    figures.insert(figures.end(), std::move_iterator(more.begin()), std::move_iterator(more.end()));
}

void draw(const std::vector<PrintFigure>& figures, const FigureOptions& options, FileSet& files,
          FigureFiles& result) {
    AddedFigures added = addFigures(figures, options.style, files);
    result.names.insert(result.names.end(), added.names.begin(), added.names.end());
    result.undrawn = std::move(added.undrawn);
    result.font = std::move(added.font);
    result.svgs = std::move(added.svgs);
    for (const PrintFigure& figure : figures)
        result.columns.push_back(figureColumns(figure, options.style));
}

}  // namespace

void checkFigures(const FigureOptions& options) {
    checkFigureStyle(options.style);
    brdfs::checkPanels(options.panels);
}

namespace {

/// A fit with the samples that its figures show: of pixels the samples of the metrics.
class PlottedFit {
public:
    explicit PlottedFit(const brdfs::FitReport& report)
        : report_(report),
          pixels_(report.samples->origin == brdfs::SampleOrigin::pixels),
          samples_(pixels_ ? *report.ofMetrics : *report.samples),
          fitted_(brdfs::openFit(report.result)) {}

    const Brdf& brdf() const { return *fitted_; }
    const brdfs::FitSamples& samples() const { return samples_; }
    bool measured() const { return samples_.origin == brdfs::SampleOrigin::measured; }

    brdfs::PlottedModel model() const {
        const brdfs::FitResult& result = report_.result;
        brdfs::PlottedModel model{
            .samples = samples_, .brdf = *fitted_, .name = "fit", .terms = termsOf(result)};
        model.residuals = brdfs::standardisedResiduals(
            samples_, brdfs::predictedValues(result, samples_),
            pixels_ ? brdfs::Loss::Kind::cosine : report_.options.loss, result.parameters.size());
        // Curves of fits with terms of the instrument are readings; bands are about f.
        if (measured() && !result.instrument && !result.point.channels.empty()) {
            model.band = [&result](std::span<const DirectionPair> pairs) {
                return halfWidths(result, pairs);
            };
            model.bandName = "95 %";
        }
        if (measured() && result.instrument)
            model.readings = [&](std::span<const DirectionPair> pairs) {
                return brdfs::readingsAt(result, samples_.channels, samples_.isotropic, pairs);
            };
        return model;
    }

private:
    const brdfs::FitReport& report_;
    bool pixels_;
    const brdfs::FitSamples& samples_;
    std::unique_ptr<Brdf> fitted_;
};

/// parameters.tex, budget.tex where there is one, and samples.csv of measured samples with a study.
void addTables(const brdfs::FitReport& report, FileSet& files, FigureFiles& result) {
    files.write("parameters.tex", brdfs::latexTable(report));
    result.names.emplace_back("parameters.tex");
    if (report.result.budget) {
        files.write("budget.tex", brdfs::latexBudget(*report.result.budget));
        result.names.emplace_back("budget.tex");
    }
    if (report.samples->origin != brdfs::SampleOrigin::measured || !report.result.uncertainty)
        return;
    files.write("samples.csv", [&](AtomicFile& file) {
        brdfs::writeResidualRows(*report.samples, report.result, report.options.loss,
                                 [&](std::string_view row) { file.write(row); });
    });
    result.names.emplace_back("samples.csv");
}

void append(std::optional<PrintFigure> one, std::vector<PrintFigure>& figures) {
    if (one) figures.push_back(std::move(*one));
}

}  // namespace

FigureFiles addFitFigures(const Brdf& data, const brdfs::FitReport& report,
                          const FigureOptions& options, FileSet& files, const Listener& listener) {
    FigureFiles result;
    addTables(report, files, result);
    const PlottedFit plotted(report);
    const brdfs::PlottedModel model = plotted.model();
    std::vector<PrintFigure> figures;
    if (plotted.measured()) {
        figures = ofSamples(model, options, result);
    } else {
        ComparisonOptions how;
        how.progress = how.sphere.progress = listener.part("report");
        figures = printFigures(makeComparison(data, plotted.brdf(), how), options.style);
        append(brdfs::sampleFigures(model, {}, options.style), figures);
    }
    append(brdfs::spectrumFigure(report.result, plotted.samples().channels), figures);
    draw(figures, options, files, result);
    return result;
}

std::vector<PrintFigure> pageFigures(const brdfs::FitReport& report, const FigureStyle& style) {
    const PlottedFit plotted(report);
    brdfs::SampleCuts cuts;
    if (plotted.measured()) cuts = brdfs::chosenCuts(brdfs::cutsOf(plotted.samples()), "auto");
    std::vector<PrintFigure> figures = brdfs::sampleFigures(plotted.model(), cuts, style);
    // The page of a comparison has a plot of this name.
    std::erase_if(figures, [](const PrintFigure& figure) { return figure.name == "polar"; });
    append(brdfs::correlationFigure(report.result), figures);
    append(brdfs::influenceFigure(report.result), figures);
    append(brdfs::spectrumFigure(report.result, plotted.samples().channels), figures);
    // Narrow pages show the columns below one another: each panel needs its own ticks.
    for (PrintFigure& figure : figures) figure.shared = false;
    return figures;
}

FigureFiles addPageFigures(const brdfs::FitReport& report, FileSet& files) {
    constexpr double pageWidth = 174;
    FigureFiles result;
    addTables(report, files, result);
    const FigureOptions options{.style = {.width = pageWidth}};
    draw(pageFigures(report, options.style), options, files, result);
    return result;
}

FigureFiles addComparisonFigures(const Comparison& comparison, const Brdf& reference,
                                 const Brdf& approximation, const std::string& sigma,
                                 const FigureOptions& options, FileSet& files) {
    FigureFiles result;
    std::vector<PrintFigure> figures = printFigures(comparison, options.style);
    const std::size_t own = approximation.channels().count();
    if (brdfs::areMeasured(reference) && (own == 1 || own == reference.channels().count())) {
        const brdfs::FitSamples samples =
            brdfs::gatherSamples(reference, {.sigma = brdfs::parseSigma(sigma)});
        brdfs::PlottedModel model{
            .samples = samples, .brdf = approximation, .name = "approximation"};
        model.residuals = brdfs::standardisedResiduals(
            samples, brdfs::valuesOf(approximation, samples), brdfs::Loss::Kind::l2, 0);
        append(ofSamples(model, options, result), figures);
    }
    draw(figures, options, files, result);
    return result;
}

}  // namespace hshfit::jobs
