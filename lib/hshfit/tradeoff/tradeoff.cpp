#include <hshfit/tradeoff/tradeoff.h>

#include <hshfit/pictures/poor.h>
#include <hshfit/representation/factoring/factoring.h>
#include <hshfit/representation/forms/pair_evaluators.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/tradeoff/internal/front.h>
#include <hshfit/tradeoff/internal/maker.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

namespace hshfit::tradeoff {
namespace {

/// Evaluators that are timed against each other in one go: as many as keep memory small.
constexpr std::size_t timedTogether = 64;

double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Steps done, from any thread.
class Steps {
public:
    Steps(const TradeoffOptions& options, std::size_t total)
        : show_(options.progress), total_(total) {}
    void done() {
        const std::size_t now = ++done_;
        if (show_) show_(std::min(now, total_), total_);
    }

private:
    const std::function<void(std::size_t, std::size_t)>& show_;
    std::size_t total_;
    std::atomic<std::size_t> done_ = 0;
};

std::size_t metricIndex(const std::string& name) {
    return static_cast<std::size_t>(selectMetrics(name).front() - metricCatalog().data());
}

constexpr std::string_view pictureMetric = "picture";

double weighed(const PairErrors& errors, const std::string& metric) {
    if (errors.values.empty() || metric == pictureMetric) return std::nan("");
    const double value = errors.values[metricIndex(metric)].value_or(std::nan(""));
    return metric == "captured-energy" ? 1 - value : value;
}

/// The outcome of one form.
struct Outcome {
    Measured measured;
    double derivationSeconds = 0;
    bool beyondBytes = false;
    std::string failure;
};

Outcome measureOne(const Form& form, const Maker& maker, const PairReference& reference,
                   const PictureReference& pictures, const TradeoffOptions& options,
                   const BrdfOpener& open) {
    Outcome outcome;
    Measured& measured = outcome.measured;
    measured.form = form;
    measured.options = optionsOf(form);
    try {
        const auto start = std::chrono::steady_clock::now();
        Representation representation = maker.make(form);
        outcome.derivationSeconds = secondsSince(start);
        measured.bytes = representation.bytes();
        outcome.beyondBytes = measured.bytes > options.maxBytes;
        if (outcome.beyondBytes) return outcome;
        measured.entropyBytes = representation.entropyBytes();
        measured.numbers = representation.numbers();
        measured.steps = representation.steps;
        const auto brdf = reconstruct(std::move(representation), open);
        if (options.metric == pictureMetric) measured.picture = pictures.errorOf(*brdf);
        auto errors = reference.errorsOf(*brdf);
        measured.summary = summaryOf(reference.pairs(), errors);
        measured.errors = std::move(errors.all);
        measured.bands = std::move(errors.bands);
    } catch (const Error& error) {
        outcome.failure = error.what();
    }
    return outcome;
}

/// The error that the fronts weigh.
double weighed(const Measured& form, const std::string& metric) {
    return metric == pictureMetric ? form.picture->flip.mean : weighed(form.errors, metric);
}

/// Hands on forms whose errors are below half of all before, as they are measured.
class Finds {
public:
    Finds(const TradeoffOptions& options, std::string brdf)
        : options_(options), brdf_(std::move(brdf)) {}
    void add(const Outcome& outcome) {
        constexpr double better = 0.5;
        if (!options_.found || !outcome.failure.empty() || outcome.beyondBytes) return;
        const double error = weighed(outcome.measured, options_.metric);
        const std::lock_guard lock(mutex_);
        if (!(error < better * least_)) return;
        least_ = error;
        options_.found(brdf_, outcome.measured, error);
    }

private:
    const TradeoffOptions& options_;
    std::string brdf_;
    std::mutex mutex_;
    double least_ = std::numeric_limits<double>::infinity();
};

/// A form to begin with, which takes little time: coefficients by outgoing direction, of no more
/// bands than `project` has by default if there are such.
const Form& firstForm(const std::vector<Form>& forms) {
    constexpr int bands = 7;
    const auto rank = [](const Form& form) {
        return std::tuple(form.kind != Representation::Kind::outgoing, !form.split.empty(),
                          form.rank > 0 || form.rankError > 0, form.order > bands,
                          form.order > bands ? form.order : -form.order);
    };
    return *std::ranges::min_element(forms, {}, rank);
}

/// The error that no factored form of any basis can beat.
void boundByRank(Tradeoff& trade, const Brdf& brdf, Quantity quantity) {
    constexpr std::size_t ranks = 8;
    trade.sliceOutgoing = brdf.laws().isotropic ? "16" : "8x8";
    if (!trade.noSquares.empty() && quantity == Quantity::brdf) return;
    try {
        const SliceSpectrum spectrum =
            sliceSpectrum(brdf, OutgoingSet::parse(trade.sliceOutgoing), quantity);
        if (!spectrum.converged) return;
        for (std::size_t r = 1; r <= ranks; ++r) {
            trade.sliceErrors.push_back(spectrum.relativeError(r));
        }
    } catch (const NumericError&) {
        return;
    }
}

void leaveOut(Tradeoff& trade, const std::string& reason, const std::string& form) {
    for (LeftOut& line : trade.leftOut) {
        if (line.reason != reason) continue;
        ++line.forms;
        return;
    }
    trade.leftOut.push_back({reason, 1, form});
}

/// Rounding alters what an evaluator holds, not what it does: forms that differ in it alone have
/// the same time.
std::string timedAs(Form form) {
    form.precision = Precision::float32;
    return optionsOf(form);
}

/// Leaves out the forms that have no time.
void leaveOutUntimed(Tradeoff& trade, const std::map<std::string, FormTime>& found) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < trade.forms.size(); ++k) {
        const auto time = found.find(timedAs(trade.forms[k].form));
        if (time == found.end()) {
            leaveOut(trade, timeIsOver, trade.forms[k].options);
            continue;
        }
        trade.times[k].evaluation = time->second;
        if (kept != k) {
            trade.forms[kept] = std::move(trade.forms[k]);
            trade.times[kept] = trade.times[k];
        }
        ++kept;
    }
    trade.forms.resize(kept);
    trade.times.resize(kept);
}

void timeForms(Tradeoff& trade, const Maker& maker, const BrdfOpener& open, const TimeLimit& limit,
               Steps& steps) {
    std::map<std::string, FormTime> found;
    std::set<std::string> seen;
    std::vector<std::string> keys;
    std::vector<std::unique_ptr<PairEvaluator>> evaluators;
    const auto timeThese = [&] {
        std::vector<const PairEvaluator*> pointers;
        for (const auto& evaluator : evaluators) pointers.push_back(evaluator.get());
        const auto times =
            timePairs(pointers, trade.channels.count(), {.done = [&] { steps.done(); }});
        for (std::size_t k = 0; k < keys.size(); ++k) found[keys[k]] = times[k];
        keys.clear();
        evaluators.clear();
    };
    for (const Measured& measured : trade.forms) {
        const std::string key = timedAs(measured.form);
        if (!seen.insert(key).second) continue;
        keys.push_back(key);
        evaluators.push_back(pairEvaluator(maker.make(measured.form), open));
        if (keys.size() < timedTogether) continue;
        timeThese();
        if (limit.isOver()) break;
    }
    timeThese();
    leaveOutUntimed(trade, found);
}

std::size_t timedCount(const std::vector<Form>& forms) {
    std::map<std::string, int> keys;
    for (const Form& form : forms) keys[timedAs(form)] = 1;
    return keys.size();
}

/// The forms of either front.
std::set<std::size_t> onFronts(const Tradeoff& trade) {
    std::set<std::size_t> forms(trade.byteFront.begin(), trade.byteFront.end());
    forms.insert(trade.timeFront.begin(), trade.timeFront.end());
    return forms;
}

void timeShadersOfFronts(Tradeoff& trade, const Maker& maker, const gpu::DeviceChoice& choice) {
    const gpu::ComputeDevice device(choice);
    MeasuredShaders& measured = trade.shaders.emplace();
    measured.device = device.name();
    measured.software = device.software();
    std::vector<gpu::TimedShader> shaders{gpu::bareShader()};
    for (const std::size_t k : onFronts(trade)) {
        MeasuredShader& form = measured.forms.emplace_back();
        form.form = k;
        try {
            shaders.push_back(gpu::timedShader(maker.make(trade.forms[k].form)));
            form.time.emplace();
        } catch (const Error& error) {
            form.reason = error.what();
        }
    }
    const std::vector<gpu::ShaderTime> times = gpu::timeShaders(device, shaders);
    measured.bare = times[0];
    std::size_t next = 1;
    for (MeasuredShader& form : measured.forms)
        if (form.time) form.time = times[next++];
}

void costFronts(Tradeoff& trade, const Maker& maker, const gpu::ShaderCosts& costs) {
    trade.costs = {costs.device(), costs.ggx()};
    for (const std::size_t k : onFronts(trade))
        trade.forms[k].cost = costs.of(maker.make(trade.forms[k].form));
}

void measureFormulas(Tradeoff& trade, const Brdf& brdf, const PairReference& reference,
                     const TradeoffOptions& options, const gpu::ShaderCosts* costs) {
    if (options.formulas.empty()) return;
    choice::MeasuredRows measured =
        choice::measureRows(choice::RowMeasurement(brdf, {}, costs), options.formulas);
    for (choice::Row& row : measured.rows) {
        auto errors = reference.errorsOf(row.made.brdf ? *row.made.brdf : brdf);
        const PairSummary summary = summaryOf(reference.pairs(), errors);
        trade.formulas.push_back({std::move(row), std::move(errors.all), summary});
    }
    for (const choice::LeftOut& line : measured.leftOut) leaveOut(trade, line.reason, line.name);
}

void findFronts(Tradeoff& trade, const TradeoffOptions& options) {
    std::vector<double> bytes, nanoseconds, errors;
    for (std::size_t k = 0; k < trade.forms.size(); ++k) {
        bytes.push_back(static_cast<double>(trade.forms[k].bytes));
        errors.push_back(trade.errorOf(k));
        if (!options.timing) continue;
        const double ns = trade.times[k].evaluation.batch.median;
        nanoseconds.push_back(ns <= options.maxNanoseconds ? ns : std::nan(""));
    }
    trade.byteFront = paretoFront(bytes, errors);
    trade.byteKnee = kneeOf(trade.byteFront, bytes, errors);
    if (!options.timing) return;
    trade.timeFront = paretoFront(nanoseconds, errors);
    trade.timeKnee = kneeOf(trade.timeFront, nanoseconds, errors);
}

/// Adds the picture errors of the forms on the fronts. For all forms they would take longer than
/// the rest.
void drawFronts(Tradeoff& trade, const Maker& maker, const PictureReference& pictures,
                const BrdfOpener& open) {
    for (const std::size_t k : onFronts(trade)) {
        if (trade.forms[k].picture) continue;
        trade.forms[k].picture =
            pictures.errorOf(*reconstruct(maker.make(trade.forms[k].form), open));
    }
}

std::vector<Form> formsFor(const Brdf& brdf, const TradeoffOptions& options) {
    if (!options.timing && options.byTime) {
        throw UsageError(fmt::format("{} needs the times that {} leaves out",
                                     Setting{"TradeoffOptions::byTime"},
                                     Setting{"TradeoffOptions::timing", "false"}));
    }
    if (!options.timing && options.gpu) {
        throw UsageError(fmt::format("{} needs the times that {} leaves out",
                                     Setting{"TradeoffOptions::gpu"},
                                     Setting{"TradeoffOptions::timing", "false"}));
    }
    if (!options.byTime && std::isfinite(options.maxNanoseconds)) {
        throw UsageError(fmt::format("{} lets times decide: add {}",
                                     Setting{"TradeoffOptions::maxNanoseconds"},
                                     Setting{"TradeoffOptions::byTime"}));
    }
    if (options.metric != pictureMetric && selectMetrics(options.metric).size() != 1) {
        throw UsageError(fmt::format("{} takes one name: {}", Setting{"TradeoffOptions::metric"},
                                     Call{.function = "metricCatalog"}));
    }
    std::vector<Form> forms = formsOf(options.sweep, brdf);
    if (forms.empty()) {
        throw UsageError(
            fmt::format("{}: no combination of these options makes a form of it", brdf.name()));
    }
    return forms;
}

}  // namespace

double Tradeoff::errorOf(std::size_t form) const {
    return weighed(forms[form], metric);
}

double Tradeoff::bandErrorOf(std::size_t form, std::size_t band) const {
    return weighed(forms[form].bands[band], metric);
}

std::optional<double> Tradeoff::uncertaintyOf(const PairErrors& errors) const {
    if (metric == pictureMetric) return std::nullopt;
    return errors.uncertainty[metricIndex(metric)];
}

std::optional<std::string> Tradeoff::poorReasonOf(std::size_t form) const {
    const double left = forms[form].summary.energyLeft.value;
    return poorReason(std::isfinite(left) ? std::optional(1 - left) : std::nullopt,
                      forms[form].picture);
}

std::optional<double> Tradeoff::shaderTimeOf(std::size_t form) const {
    if (!shaders) return {};
    const auto row = std::ranges::find(shaders->forms, form, &MeasuredShader::form);
    if (row == shaders->forms.end() || !row->time) return {};
    return row->time->median;
}

double Tradeoff::formulaErrorOf(std::size_t formula) const {
    const MeasuredFormula& measured = formulas[formula];
    return metric == pictureMetric ? measured.row.picture.flip.mean
                                   : weighed(measured.errors, metric);
}

double Tradeoff::waveletErrorOf(std::size_t form) const {
    return weighed(wavelets[form].errors, metric);
}

std::vector<std::size_t> Tradeoff::waveletFront() const {
    std::vector<double> bytes, errors;
    for (std::size_t k = 0; k < wavelets.size(); ++k) {
        bytes.push_back(static_cast<double>(wavelets[k].bytes));
        errors.push_back(waveletErrorOf(k));
    }
    return paretoFront(bytes, errors);
}

Tradeoff measure(const Brdf& brdf, PairSample pairs, const TradeoffOptions& options,
                 const BrdfOpener& open) {
    const std::vector<Form> forms = formsFor(brdf, options);
    // A device or a compiler that is none fails before the long work.
    if (options.gpu) gpu::ComputeDevice{*options.gpu};
    std::optional<gpu::ShaderCosts> costs;
    if (options.costs) costs.emplace();
    Steps steps(options, Maker::projectionsFor(forms) + forms.size() +
                             (options.timing ? timedCount(forms) : 0));
    const PairReference reference(brdf, std::move(pairs));
    Tradeoff trade{.brdf = brdf.name(),
                   .channels = brdf.channels(),
                   .laws = brdf.laws(),
                   .metric = options.metric,
                   .tolerance = options.projection.tolerance,
                   .pairs = reference.pairs().size(),
                   .noSquares = reference.noSquares()};
    const PictureReference pictures(brdf);
    Finds finds(options, trade.brdf);
    if (options.found) {
        const Form& form = firstForm(forms);
        Maker maker(brdf, options.projection, options.folder, open);
        maker.prepare({form}, {}, [] {});
        finds.add(measureOne(form, maker, reference, pictures, options, open));
    }
    boundByRank(trade, brdf, options.sweep.quantity);
    const TimeLimit limit = options.limit.share(options.timing ? 4.0 / 3 : 1);
    Maker maker(brdf, options.projection, options.folder, open);
    maker.prepare(forms, limit.share(4), [&] { steps.done(); });

    std::vector<Outcome> outcomes(forms.size());
    tbb::parallel_for(std::size_t{0}, forms.size(), [&](std::size_t k) {
        if (limit.isOver()) {
            outcomes[k].measured.options = optionsOf(forms[k]);
            outcomes[k].failure = timeIsOver;
        } else {
            outcomes[k] = measureOne(forms[k], maker, reference, pictures, options, open);
        }
        finds.add(outcomes[k]);
        steps.done();
    });
    for (Outcome& outcome : outcomes) {
        if (!outcome.failure.empty()) {
            leaveOut(trade, outcome.failure, outcome.measured.options);
        } else if (outcome.beyondBytes) {
            ++trade.beyondBytes;
        } else {
            trade.forms.push_back(std::move(outcome.measured));
            if (!options.timing) continue;
            trade.times.push_back(
                {maker.projectionSeconds(trade.forms.back().form), outcome.derivationSeconds, {}});
        }
    }
    if (trade.forms.empty()) {
        throw NumericError(fmt::format(
            "{}: no form is left: {}", brdf.name(),
            trade.leftOut.empty()
                ? fmt::format("all take more than {}", Setting{"TradeoffOptions::maxBytes"})
                : trade.leftOut[0].reason));
    }
    if (options.wavelets) {
        trade.wavelets = measureWavelets(brdf, reference, options.sweep, options.maxBytes);
    }
    if (options.timing) timeForms(trade, maker, open, options.limit, steps);
    findFronts(trade, options);
    drawFronts(trade, maker, pictures, open);
    if (!options.limit.isOver())
        measureFormulas(trade, brdf, reference, options, costs ? &*costs : nullptr);
    if (costs) costFronts(trade, maker, *costs);
    if (options.gpu) timeShadersOfFronts(trade, maker, *options.gpu);
    brdf.checkIntact();
    return trade;
}

}  // namespace hshfit::tradeoff
