#include "fit.h"

#include <jobs/source/source.h>
#include "certificate.h"
#include "fit_bands.h"
#include "fit_page.h"
#include "grey_colours.h"

#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/pages/comparison.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>
#include <brdfs/composed/sum.h>
#include <brdfs/fit/fit_json.h>
#include <brdfs/fit/picture_samples.h>
#include <brdfs/fit/residual_rows.h>
#include <brdfs/measured/mueller.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::jobs {
namespace {

constexpr std::size_t fewSamples = 4096;  ///< of fits that are tried

/// `drawn`: into figures or a page, which have a row for each measured sample.
brdfs::FitOptions optionsOf(const FitOptions& options, const Brdf& data, bool drawn) {
    brdfs::FitOptions fit;
    fit.model = options.model;
    fit.loss = brdfs::findLoss(lossOf(options, data)).kind;
    fit.robust = brdfs::findRobust(options.robust);
    fit.robustScale = options.robustScale;
    fit.perChannel = options.perChannel;
    fit.dispersion = options.dispersion;
    fit.starts = options.starts;
    fit.seed = options.seed;
    fit.iterations = options.iterations;
    fit.limit = TimeLimit(options.seconds);
    fit.uncertainty.report = !options.sigma.empty() || !options.scans.empty() ||
                             options.bootstrap > 0 || options.profile ||
                             !options.residuals.empty() || options.instrument.any();
    if (!options.calibration.empty())
        fit.contributions.push_back(brdfs::parseCalibration(options.calibration));
    if (!options.budget.empty())
        for (brdfs::Contribution& own : brdfs::readContributions(options.budget))
            fit.contributions.push_back(std::move(own));
    fit.uncertainty.report = fit.uncertainty.report || !fit.contributions.empty();
    // A robust kernel has no such study.
    if (drawn && fit.robust == brdfs::Robust::none && fit.loss != brdfs::Loss::Kind::picture &&
        brdfs::areMeasured(data))
        fit.uncertainty.report = true;
    fit.uncertainty.bootstrap = options.bootstrap;
    fit.uncertainty.profile = options.profile;
    fit.instrument = brdfs::parseInstrument(options.instrument);
    return fit;
}

/// Whether an option is about single samples, which pixels are not.
std::optional<Setting> sampleSetting(const FitOptions& options) {
    const std::pair<bool, const char*> rows[] = {
        {options.weights != "auto", "FitOptions::weights"},
        {options.places != "auto", "FitOptions::places"},
        {!options.sigma.empty(), "FitOptions::sigma"},
        {!options.scans.empty(), "FitOptions::scans"},
        {!options.calibration.empty(), "FitOptions::calibration"},
        {!options.budget.empty(), "FitOptions::budget"},
        {options.bootstrap > 0, "FitOptions::bootstrap"},
        {options.profile, "FitOptions::profile"},
        {!options.residuals.empty(), "FitOptions::residuals"},
        {!options.instrument.source.empty(), "FitOptions::instrument.source"},
        {!options.instrument.detector.empty(), "FitOptions::instrument.detector"},
        {!options.instrument.bandwidth.empty(), "FitOptions::instrument.bandwidth"},
        {!options.instrument.offset.empty(), "FitOptions::instrument.offset"},
        {!options.instrument.dark.empty(), "FitOptions::instrument.dark"},
        {!options.instrument.stray.empty(), "FitOptions::instrument.stray"},
        {!options.instrument.scale.empty(), "FitOptions::instrument.scale"},
        {!options.instrument.incidenceZero.empty(), "FitOptions::instrument.incidenceZero"},
        {!options.instrument.detectorZero.empty(), "FitOptions::instrument.detectorZero"},
        {!options.bands.empty(), "FitOptions::bands"},
        {!options.certificate.empty(), "FitOptions::certificate"},
    };
    for (const auto& [given, name] : rows)
        if (given) return Setting{name};
    return std::nullopt;
}

/// Throws UsageError for data or a model of transmission.
void requireReflections(const Brdf& data, const std::string& model) {
    requireReflection(data, "fit");
    brdfs::requireReflectance(data, "fit");
    for (const brdfs::WeightedSpec& term :
         brdfs::splitSum(model, [](std::string_view) { return false; })) {
        const std::string_view name = std::string_view(term.spec).substr(0, term.spec.find(':'));
        const auto row = std::ranges::find(brdfs::models(), name, &brdfs::Model::name);
        if (row != brdfs::models().end() &&
            std::ranges::find(row->parameters, "side", &Parameter::name) != row->parameters.end())
            throw UsageError(fmt::format(
                "{}: is a model of transmission; expected models of reflection, as the data are",
                name));
    }
}

brdfs::FitSamples samplesOf(const FitOptions& options, const Brdf& data, brdfs::Loss::Kind loss) {
    const brdfs::SampleOptions how{.weights = brdfs::findSampleWeights(options.weights),
                                   .places = brdfs::findSamplePlaces(options.places),
                                   .grazingCut = options.grazingCut,
                                   .most = options.samples,
                                   .seed = options.seed,
                                   .sigma = brdfs::parseSigma(options.sigma),
                                   .scans = brdfs::parseScans(options.scans)};
    brdfs::FitSamples samples;
    if (loss == brdfs::Loss::Kind::picture) {
        if (const auto setting = sampleSetting(options))
            throw UsageError(
                fmt::format("{} is about single samples, and the loss picture fits pixels of lit "
                            "spheres; leave it out, or choose another loss",
                            *setting));
        samples = brdfs::pictureSamples(data, {.grazingCut = options.grazingCut});
        if (options.samples > 0) samples = samples.drawn(options.samples, options.seed);
    } else {
        if (!options.sigma.empty() && how.weights == brdfs::SampleWeights::solidAngle)
            throw UsageError(fmt::format("{} states the weights of the samples; leave out {}",
                                         Setting{"FitOptions::sigma"},
                                         Setting{"FitOptions::weights"}));
        samples = brdfs::gatherSamples(data, how);
    }
    requireReadable(data);
    return samples;
}

/// The root of the weighted mean square of what the samples show about their mean.
double spreadOf(const brdfs::FitSamples& samples, brdfs::Loss::Kind loss) {
    double variance = 0;
    const auto channels = samples.channels.count();
    for (std::size_t c = 0; c < channels; ++c) {
        double sum = 0, squares = 0, weights = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const double g = brdfs::mapValue(loss, samples.value(c, k), samples.wiZ[k]).value;
            weights += samples.weights[k];
            sum += samples.weights[k] * g;
            squares += samples.weights[k] * g * g;
        }
        variance += (squares - sum * sum / weights) / (weights * static_cast<double>(channels));
    }
    return std::sqrt(std::max(variance, 0.0));
}

double explainedBy(const brdfs::FitResult& result, const brdfs::FitSamples& samples,
                   brdfs::Loss::Kind loss) {
    const double unit = loss == brdfs::Loss::Kind::picture
                            ? spreadOf(samples, loss)
                            : brdfs::lossOf(*brdfs::open("lambert:kd=0"), samples, loss);
    return unit > 0 ? 1 - (result.loss / unit) * (result.loss / unit) : 1;
}

std::vector<std::string> namesIn(const std::string& list) {
    std::vector<std::string> names;
    for (std::size_t first = 0; first <= list.size();) {
        const std::size_t last = std::min(list.find(',', first), list.size());
        names.push_back(list.substr(first, last - first));
        first = last + 1;
    }
    return names;
}

/// Restricts a model to the parts that are asked for, or that are worth it.
std::optional<brdfs::PartSearch> restrictParts(const FitOptions& options,
                                               const brdfs::FitSamples& samples,
                                               brdfs::FitOptions& how, const Listener& listener) {
    const brdfs::Model* model = brdfs::modelWithParts(how.model);
    if (!model || how.model.find('+') != how.model.npos) {
        if (options.parts.empty()) return {};
        throw UsageError(fmt::format("{}: {} is for models with optional parts", how.model,
                                     Setting{"FitOptions::parts"}));
    }
    brdfs::PartSearch search;
    if (options.parts == "all") {
        how.model = brdfs::withParts(how.model, brdfs::partsFor(*model, samples.channels));
        return {};
    }
    if (options.parts.empty() || options.parts == "auto")
        search = brdfs::chooseParts(samples, how, {.progress = listener.part("parts")});
    else if (options.parts != "none")
        search.parts = namesIn(options.parts);
    how.model = brdfs::withParts(how.model, search);
    how.from = search.from;
    return search;
}

/// The fit with these parts. A film has to lower the loss of all samples too, of which the search
/// saw a few, and the FLIP of pictures: else the fit is the one without.
Fitted fitWithParts(const FitOptions& options, const brdfs::FitSamples& samples,
                    const PictureReference* seen, brdfs::FitOptions& how,
                    const Listener& listener) {
    brdfs::FitOptions bare = how;
    auto search = restrictParts(options, samples, how, listener);
    how.progress = bare.progress = listener.part("fit");
    how.uncertainty.progress = bare.uncertainty.progress = listener.part("errors");
    brdfs::FitResult result = brdfs::fit(samples, how);
    if (search && !search->stated.empty()) {
        const std::string none = search->stated.substr(0, search->stated.find('=')) + "=0";
        bare.model += (bare.model.find(':') == bare.model.npos ? ":" : ",") + none;
        brdfs::PartSearch without = brdfs::chooseParts(samples, bare, {});
        bare.model = brdfs::withParts(bare.model, without);
        brdfs::FitResult plain = brdfs::fit(samples, bare);
        const auto flipOf = [&](const brdfs::FitResult& own) {
            return seen ? seen->errorOf(*brdfs::openFit(own)).flip.mean : 0;
        };
        if (result.loss > (1 - brdfs::PartOptions{}.leastGain) * plain.loss ||
            flipOf(result) > flipOf(plain)) {
            without.trials.push_back(
                {.parts = search->parts,
                 .loss = std::ranges::find(search->trials, search->parts, &brdfs::PartTrial::parts)
                             ->loss,
                 .failure = "a film that all pixels or their FLIP find no better, not taken"});
            search = std::move(without), how = std::move(bare), result = std::move(plain);
        }
    }
    return {.result = std::move(result), .search = std::move(search), .preset = {}};
}

/// Fits in place of a poor one, made in brief: a second lobe and sums of the catalog that are known
/// to describe much, where no standard material was asked for, and the model by other losses.
/// `seen`: of the data; null where it has no pictures. A lower FLIP does not count where the
/// colours of the sphere are further off than in the poor fit, as on a sphere that is lit all
/// over.
std::vector<TriedFit> triedFits(const Brdf& data, const brdfs::FitSamples& samples,
                                const FitOptions& options, brdfs::FitOptions how,
                                const PictureReference* seen, const Fitted& poor) {
    const bool pixels = samples.origin == brdfs::SampleOrigin::pixels;
    const std::string own = how.model;
    how.starts = 2;
    how.iterations = 60;
    how.progress = {};
    how.uncertainty = {};
    how.contributions.clear();
    how.dispersion = {};
    std::vector<TriedFit> tried;
    const auto attempt = [&](const std::string& model, const brdfs::FitSamples& places,
                             const std::string& loss) {
        how.model = model;
        try {
            const brdfs::FitResult result = brdfs::fit(places, how);
            // Nearly as many parameters as values describe any data.
            if (result.values < 2 * result.parameters.size()) return;
            tried.push_back(
                {.model = model, .loss = loss, .explained = explainedBy(result, places, how.loss)});
            if (seen) {
                const PictureError error = seen->errorOf(*brdfs::openFit(result));
                if (error.colour.mean <= poor.picture->colour.mean)
                    tried.back().flip = error.flip.mean;
            }
            if (places.origin != brdfs::SampleOrigin::measured) return;
            const auto values = brdfs::predictedValues(result, places);
            if (const auto factors = brdfs::factorsOf(values, places))
                tried.back().factor = factors->median;
        } catch (const Error&) {
            // A model that these samples do not determine is no better one.
        }
    };
    const brdfs::FitSamples places = samples.drawn(pixels ? samples.size() : fewSamples, how.seed);
    std::vector<std::string> wider;
    if (!brdfs::modelWithParts(own))
        wider = {own + (own.starts_with("ggx") ? "+eon" : "+ggx"), "lambert+ggx",
                 "lambert+ggx+ggx"};
    for (const std::string& model : wider)
        if (model != own && std::ranges::find(tried, model, &TriedFit::model) == tried.end())
            attempt(model, places, {});
    if (sampleSetting(options)) return tried;
    using Kind = brdfs::Loss::Kind;
    const Kind stated = how.loss;
    for (const Kind loss : {Kind::picture, Kind::log, Kind::logRelative}) {
        if (loss == stated || (loss != Kind::logRelative) != (seen != nullptr)) continue;
        how.loss = loss;
        FitOptions chosen = options;
        chosen.samples = loss == Kind::picture ? 0 : fewSamples;
        attempt(own, samplesOf(chosen, data, loss), std::string(brdfs::lossName(loss)));
        if (!tried.empty() && tried.back().model == own) tried.back().model = options.model;
    }
    return tried;
}

std::optional<Poor> judged(const Fitted& fitted, const Brdf& brdf, const brdfs::FitSamples& samples,
                           const std::string& data, const FitOptions& options,
                           const brdfs::FitOptions& how, const PictureReference* seen) {
    FitCall call{.data = data,
                 .model = options.model,
                 .explained = fitted.explained,
                 .relativeError = fitted.relativeError,
                 .factor = fitted.factors ? fitted.factors->median : 1,
                 .loss = brdfs::lossName(how.loss),
                 .otherwise = adviceBeyondModels(brdf)};
    if (!options.loss.empty()) call.settings.push_back({"FitOptions::loss", options.loss});
    if (!options.sigma.empty()) call.settings.push_back({"FitOptions::sigma", options.sigma});
    std::optional<Poor> poor = judgeFit(
        fitted.picture, call, [&] { return triedFits(brdf, samples, options, how, seen, fitted); });
    const std::string grey = greyColours(fitted.result, samples, how);
    if (grey.empty()) return poor;
    if (!poor) return Poor{grey, {}, "a model in whose colours f is linear, such as lambert+ggx"};
    poor->reason = grey + "; " + poor->reason;
    return poor;
}

/// The residuals' file, complete but not yet under its name: none if no path is given.
std::unique_ptr<AtomicFile> residualsOf(const brdfs::FitSamples& samples,
                                        const brdfs::FitResult& result, brdfs::Loss::Kind loss,
                                        const std::string& path) {
    if (path.empty()) return nullptr;
    auto file = std::make_unique<AtomicFile>(path);
    brdfs::writeResidualRows(samples, result, loss,
                             [&](std::string_view row) { file->write(row); });
    file->finish();
    return file;
}

}  // namespace

std::string lossOf(const FitOptions& options, const Brdf& data) {
    if (!options.loss.empty()) return options.loss;
    if (!options.sigma.empty()) return "l2";
    if (brdfs::areMeasured(data)) {
        const auto samples = brdfs::gatherSamples(data, {.grazingCut = options.grazingCut});
        return brdfs::decadesOf(samples) > brdfs::mostDecades ? "log-relative" : "cosine";
    }
    return sampleSetting(options) || options.robust != "none" ? "cosine" : "picture";
}

bool isPresetPath(const std::string& output) {
    return extensionOf(output) == ".json";
}

std::string presetText(const Fitted& fitted) {
    return jsonText(fitted.preset, 2) + "\n";
}

namespace {

/// Files that are complete but not yet under their names; null: not asked for.
struct PreparedFiles {
    std::unique_ptr<AtomicFile> residuals, bands;
    std::unique_ptr<FileSet> figures, page, certificate;
    FitSection section = {};  ///< of the page

    void commit(const Fitted& fitted) const {
        if (residuals) residuals->commit();
        if (bands) bands->commit();
        if (figures) figures->commit();
        if (page) page->commit();
        if (certificate) certificate->commit();
        for (const auto& undrawn : {fitted.figures.undrawn, section.undrawn})
            if (undrawn) throw NoFigures(*undrawn);
    }
};

/// Adds the page that shows the fit and compares it with the data, and fit.json.
void addPage(const Brdf& data, Fitted& fit, PreparedFiles& files, const Listener& listener) {
    const auto fitted = brdfs::openFit(fit.result);
    ComparisonOptions options;
    options.picture = fit.picture;
    options.progress = options.sphere.progress = listener.part("report");
    AddedComparison added =
        addComparison(makeComparison(data, *fitted, options), *files.page, files.section.html);
    files.page->write("fit.json", presetText(fit));
    if (!files.section.undrawn) files.section.undrawn = std::move(added.undrawn);
    fit.pageFiles = added.names.size() + files.section.names.size();
}

/// A fit, and its other files; `page` is the folder of its page, or empty.
std::pair<Fitted, PreparedFiles> fitOpen(const Brdf& brdf, const std::string& data,
                                         const FitOptions& options, const std::string& page,
                                         const Listener& listener) {
    requireReflections(brdf, options.model);
    PreparedFiles files;
    // A wrong list of pairs, or of fields, is known before the fit.
    if (!options.bands.empty()) bandPairs(options.bands);
    if (!options.certificate.empty() && extensionOf(options.certificate) != ".pdf")
        throw UsageError(fmt::format("{} has to end in .pdf",
                                     Setting{"FitOptions::certificate", options.certificate}));
    if (!options.certificateFields.empty()) readCertificateFields(options.certificateFields);
    if (options.figures) {
        checkFigures(*options.figures);
        files.figures =
            std::make_unique<FileSet>(options.figures->folder, true, FileSet::Above::require);
    }
    if (!page.empty()) files.page = std::make_unique<FileSet>(page, true, FileSet::Above::require);
    brdfs::FitOptions how =
        optionsOf(options, brdf, options.figures || !page.empty() || !options.certificate.empty());
    const brdfs::FitSamples samples = samplesOf(options, brdf, how.loss);
    std::optional<PictureReference> seen;
    // Between scattered samples the data are a guess: pictures of that say nothing of a fit.
    if (!brdfs::areMeasured(brdf)) seen.emplace(brdf);
    Fitted fitted = fitWithParts(options, samples, seen ? &*seen : nullptr, how, listener);
    if (!fitted.result.converged && !options.accept) {
        throw NumericError(
            fmt::format("{}: the fit of {} did not converge ({}); {} takes it as it "
                        "is",
                        data, options.model, fitted.result.message, Setting{"FitOptions::accept"}));
    }
    if (seen) fitted.picture = seen->errorOf(*brdfs::openFit(fitted.result));
    // Metrics are about f, not pixels.
    const bool pixels = samples.origin == brdfs::SampleOrigin::pixels;
    const brdfs::FitSamples ofMetrics =
        pixels ? brdfs::gatherSamples(brdf, {.grazingCut = options.grazingCut})
               : brdfs::FitSamples();
    const brdfs::FitReport report{data,
                                  &samples,
                                  how,
                                  fitted.result,
                                  options.sigma,
                                  options.scans,
                                  pixels ? &ofMetrics : &samples};
    fitted.preset = brdfs::fitPreset(report);
    for (const auto& metric : fitted.preset["fit"]["metrics"])
        if (metric["name"] == "relative-l2-cosine" && metric["value"].is_number())
            fitted.relativeError = metric["value"];
    fitted.explained = explainedBy(fitted.result, samples, how.loss);
    if (samples.origin == brdfs::SampleOrigin::measured) {
        const auto values = brdfs::predictedValues(fitted.result, samples);
        fitted.factors = brdfs::factorsOf(values, samples);
    }
    if (options.advise)
        fitted.poor = judged(fitted, brdf, samples, data, options, how, seen ? &*seen : nullptr);
    if (fitted.picture) fitted.preset["picture"] = pictureErrorJson(*fitted.picture);
    if (fitted.factors)
        fitted.preset["fit"]["factors"] = {{"median", finiteOrNull(fitted.factors->median)},
                                           {"nine_of_ten", finiteOrNull(fitted.factors->nineOfTen)},
                                           {"values", fitted.factors->count}};
    fitted.preset["fit"]["explained"] = fitted.explained;
    fitted.preset["fit"]["relative_error"] = fitted.relativeError;
    if (fitted.search) fitted.preset["fit"]["parts"] = brdfs::searchJson(*fitted.search);
    files.residuals = residualsOf(samples, fitted.result, how.loss, options.residuals);
    if (files.figures)
        fitted.figures = addFitFigures(brdf, report, *options.figures, *files.figures, listener);
    files.bands = addBands(options, samples.channels, fitted);
    if (!options.certificate.empty())
        files.certificate = makeCertificate(report, presetText(fitted), options.certificateFields,
                                            options.certificate);
    if (files.page) {
        files.section = addFitSection(report, fitted.preset["fit"], *files.page);
        addPage(brdf, fitted, files, listener);
    }
    return {std::move(fitted), std::move(files)};
}

}  // namespace

Fitted fitBrdf(const Brdf& brdf, const std::string& data, const FitOptions& options,
               const Listener& listener) {
    auto [fitted, files] = fitOpen(brdf, data, options, {}, listener);
    files.commit(fitted);
    return std::move(fitted);
}

Fitted fit(const std::string& data, const std::string& output, const FitOptions& options,
           const Listener& listener) {
    const auto brdf = openSource(data, options.rgb);
    const bool preset = isPresetPath(output);
    auto [fitted, files] = fitOpen(*brdf, data, options, preset ? "" : output, listener);
    if (preset) writeFile(output, presetText(fitted));
    files.commit(fitted);
    return std::move(fitted);
}

BatchOutcome fitAll(const std::string& folder, const std::string& results,
                    const FitOptions& options, const Listener& listener) {
    return fitFolder(
        folder, results,
        [&](const std::string& file, const std::string& result) { fit(file, result, options); },
        listener.part("files"));
}

RankedModels rankModels(const std::string& data, const std::vector<std::string>& models,
                        const FitOptions& options) {
    return rankModels(*openSource(data, options.rgb), models, options);
}

RankedModels rankModels(const Brdf& data, const std::vector<std::string>& models,
                        const FitOptions& options) {
    for (const std::string& model : models) requireReflections(data, model);
    const brdfs::FitOptions how = optionsOf(options, data, options.figures.has_value());
    const brdfs::FitSamples samples = samplesOf(options, data, how.loss);
    return {lossOf(options, data), brdfs::compareModels(samples, models, how)};
}

}  // namespace hshfit::jobs
