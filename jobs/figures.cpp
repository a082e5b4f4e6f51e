#include "figures.h"

#include <hshfit/pages/comparison_print.h>

#include <brdfs/fit/budget_latex.h>
#include <brdfs/fit/fit_figures.h>
#include <brdfs/fit/instrument/instrument_fit.h>
#include <brdfs/fit/latex_table.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/fit/residual_rows.h>

#include <iterator>
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

/// Of the band that holds the true f with 95 % at each pair.
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
}

}  // namespace

void checkFigures(const FigureOptions& options) {
    checkFigureStyle(options.style);
    brdfs::checkPanels(options.panels);
}

FigureFiles addFitFigures(const Brdf& data, const brdfs::FitReport& report,
                          const FigureOptions& options, FileSet& files, const Listener& listener) {
    FigureFiles result;
    const auto write = [&](const std::string& name, const std::function<void(AtomicFile&)>& fill) {
        files.write(name, fill);
        result.names.push_back(name);
    };
    write("parameters.tex", [&](AtomicFile& file) { file.write(brdfs::latexTable(report)); });
    if (report.result.budget)
        write("budget.tex",
              [&](AtomicFile& file) { file.write(brdfs::latexBudget(*report.result.budget)); });
    const bool pixels = report.samples->origin == brdfs::SampleOrigin::pixels;
    const brdfs::FitSamples& samples = pixels ? *report.ofMetrics : *report.samples;
    const auto fitted = brdfs::openFit(report.result);
    brdfs::PlottedModel model{
        .samples = samples, .brdf = *fitted, .name = "fit", .terms = termsOf(report.result)};
    model.residuals = brdfs::standardisedResiduals(
        samples, brdfs::predictedValues(report.result, samples),
        pixels ? brdfs::Loss::Kind::cosine : report.options.loss, report.result.parameters.size());
    std::vector<PrintFigure> figures;
    if (samples.origin == brdfs::SampleOrigin::measured) {
        if (report.result.uncertainty)
            write("samples.csv", [&](AtomicFile& file) {
                brdfs::writeResidualRows(samples, report.result, report.options.loss,
                                         [&](std::string_view row) { file.write(row); });
            });
        // Curves of fits with terms of the instrument are readings; bands are those of f.
        if (!report.result.instrument && !report.result.point.channels.empty()) {
            model.band = [&](std::span<const DirectionPair> pairs) {
                return halfWidths(report.result, pairs);
            };
            model.bandName = "95 %";
        }
        if (report.result.instrument)
            model.readings = [&](std::span<const DirectionPair> pairs) {
                return brdfs::readingsAt(report.result, samples.channels, samples.isotropic, pairs);
            };
        figures = ofSamples(model, options, result);
    } else {
        ComparisonOptions how;
        how.progress = how.sphere.progress = listener.part("report");
        figures = printFigures(makeComparison(data, *fitted, how), options.style);
        append(brdfs::sampleFigures(model, {}, options.style), figures);
    }
    if (auto spectrum = brdfs::spectrumFigure(report.result, samples.channels))
        figures.push_back(std::move(*spectrum));
    draw(figures, options, files, result);
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
