#include <brdfs/fit/instrument/instrument_fit.h>

#include <brdfs/fit/filled_in.h>
#include <brdfs/fit/instrument/instrument_problem.h>
#include <brdfs/fit/instrument/instrument_study.h>
#include <brdfs/fit/instrument/quadratures.h>
#include <brdfs/fit/material_fit.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace hshfit::brdfs {
namespace {

/// x of the material in a result.
std::vector<double> materialOf(const FitResult& result, const ParametricSum& sum,
                               std::size_t channels) {
    const std::size_t shapes = sum.shapes().size();
    std::vector<double> x;
    for (std::size_t i = 0; i < shapes + sum.linears().size() * channels; ++i) {
        const double value = result.parameters[i].value;
        x.push_back(i < shapes ? sum.shapes()[i].toScale(value) : value);
    }
    return x;
}

/// Readings as they would be without what the instrument adds, and with a scale of 1.
FitSamples corrected(const InstrumentProblem& problem, const std::vector<double>& x) {
    const ReadingRows rows = problem.rows(x, false);
    FitSamples samples = problem.readings().samples;
    const std::size_t count = samples.size();
    for (std::size_t v = 0; v < samples.values.size(); ++v) {
        // A scale far from 1 says nothing at the start of a search.
        const double scale = std::clamp(rows.scales[problem.scanOf(v % count)], 0.5, 2.0);
        samples.values[v] = (samples.values[v] - rows.added[v]) / scale;
        if (!samples.sigmas.empty()) samples.sigmas[v] /= scale;
    }
    samples.scans.clear();
    samples.correlation = {};
    return samples;
}

FitResult searchMaterial(const FitSamples& samples, const FitOptions& options) {
    FitOptions plain = options;
    plain.instrument = {};
    plain.uncertainty = {};
    plain.contributions.clear();
    plain.progress = {};
    return fitMaterial(samples, plain, false);
}

Minimum minimised(const InstrumentProblem& problem, const std::vector<double>& start,
                  const FitOptions& options) {
    const Bounds bounds = problem.bounds();
    return minimise([&](std::span<const double> x,
                        bool derivatives) { return problem.equations(x, derivatives); },
                    start, bounds.lower, bounds.upper, {.iterations = options.iterations});
}

/// The better of minima from a start and from a search on readings corrected by the first.
Minimum searched(const InstrumentProblem& problem, const std::vector<double>& start,
                 const FitOptions& options) {
    Minimum best = minimised(problem, start, options);
    const FitResult again = searchMaterial(corrected(problem, best.x), options);
    std::vector<double> other = best.x;
    std::ranges::copy(materialOf(again, problem.sum(), problem.channels()), other.begin());
    Minimum second = minimised(problem, other, options);
    const int iterations = best.iterations + second.iterations,
              evaluations = best.evaluations + second.evaluations;
    if (second.cost < best.cost || !std::isfinite(best.cost)) best = std::move(second);
    best.iterations = iterations;
    best.evaluations = evaluations;
    return best;
}

/// Sets the specification, or specifications of wavelengths, of the material at x.
void setMaterial(const InstrumentProblem& problem, const std::vector<double>& x,
                 FitResult& result) {
    const std::size_t shapes = problem.shapeCount();
    std::vector<double> values;
    for (std::size_t j = 0; j < shapes; ++j)
        values.push_back(problem.sum().shapes()[j].toValue(x[j]));
    const std::vector<double> linear(
        x.begin() + static_cast<std::ptrdiff_t>(shapes),
        x.begin() + static_cast<std::ptrdiff_t>(shapes + problem.sum().linears().size() *
                                                             problem.channels()));
    result.model = problem.sum().spec();
    fillIn(problem.sum(), {values}, linear, problem.readings().samples.channels, result);
}

FittedInstrument fittedAt(const InstrumentProblem& problem, const std::vector<double>& x,
                          const Quadratures& quadratures) {
    using From = InstrumentTerm::From;
    const Instrument& instrument = problem.readings().instrument;
    const std::size_t channels = problem.channels();
    FittedInstrument result;
    result.instrument = instrument;
    const auto of = [&](const InstrumentTerm& term, std::optional<std::size_t> place) {
        std::vector<double> values;
        if (term.from == From::stated) values.assign(channels, term.value);
        for (std::size_t c = 0; place && c < channels; ++c) values.push_back(x[*place + c]);
        return values;
    };
    result.offset = of(instrument.offset, problem.offsetPlace());
    result.dark = of(instrument.dark, problem.darkPlace());
    result.stray = problem.strayPlace() ? x[*problem.strayPlace()] : instrument.stray.value;
    if (instrument.scales) result.scales = problem.rows(x, false).scales;
    for (const InstrumentProblem::Zero& zero : problem.zeros()) {
        const auto first = x.begin() + static_cast<std::ptrdiff_t>(zero.first);
        (zero.detector ? result.detectorZeros : result.incidenceZeros)
            .assign(first, first + static_cast<std::ptrdiff_t>(zero.priors.size()));
    }
    quadratures.describe(problem.readings().samples, result);
    return result;
}

/// Loss and information criteria. Scales without a width count as parameters; scales with a width
/// do not, and neither do zeros of angles, because the width holds them.
void addStatistics(const InstrumentProblem& problem, const std::vector<double>& x,
                   FitResult& result) {
    const ReadingRows rows = problem.rows(x, false);
    const FitSamples& samples = problem.readings().samples;
    double squares = 0, weights = 0, priors = problem.zeroSquares(x), free = 0;
    for (std::size_t v = 0; v < rows.material.size(); ++v) {
        const double r = rows.scales[problem.scanOf(v % samples.size())] * rows.material[v] +
                         rows.added[v] - samples.values[v];
        squares += rows.weights[v] * r * r;
        weights += samples.weight(v / samples.size(), v % samples.size());
    }
    for (std::size_t s = 0; s < problem.scanCount(); ++s) {
        priors += problem.priorSquare(s, rows.scales[s]);
        free += problem.freeScale(s) && !(problem.priorOf(s) > 0) ? 1 : 0;
    }
    for (const InstrumentProblem::Zero& zero : problem.zeros())
        free -= static_cast<double>(zero.priors.size());
    result.loss = std::sqrt(squares / weights);
    const bool stated = !samples.sigmas.empty();
    const double count = static_cast<double>(samples.values.size()),
                 parameters = static_cast<double>(problem.count()) + free + (stated ? 0 : 1);
    const double likelihood =
        stated ? squares + priors : count * std::log(std::max(squares / weights, 1e-300));
    result.aic = likelihood + 2 * parameters;
    result.bic = likelihood + parameters * std::log(count);
}

}  // namespace

void checkReadings(const FitSamples& samples, const FitOptions& options) {
    checkInstrument(options.instrument, samples);
    if (options.loss != Loss::Kind::l2 && options.loss != Loss::Kind::cosine)
        throw UsageError(
            "terms of an instrument are fitted with the losses l2 and cosine, which are linear in "
            "readings");
    if (options.robust != Robust::none)
        throw UsageError("terms of an instrument are fitted without a robust kernel");
    if (options.perChannel && samples.channels.count() > 1)
        throw UsageError(
            "terms of an instrument are those of all channels; leave out shapes for each channel");
}

FitResult fitWithInstrument(const FitSamples& samples, const FitOptions& options) {
    checkReadings(samples, options);
    const Instrument& instrument = options.instrument;
    const ParametricSum sum(options.model, samples.isotropic);
    Readings readings{.samples = samples, .instrument = instrument};
    readings.mix = slitMatrix(instrument.slit, samples.channels);
    Quadratures quadratures;
    quadratures.levels.resize(samples.size());

    // At the nominal directions, without anything that is fitted.
    FitSamples stated = withoutStated(samples, instrument);
    stated.scans.clear();
    stated.correlation = {};
    FitResult result = searchMaterial(stated, options);
    std::vector<double> x = materialOf(result, sum, samples.channels.count());
    quadratures.refine(*openFit(result), samples, instrument);
    constexpr int most = 8;
    int iterations = result.iterations, evaluations = result.evaluations;
    for (int round = 0; round < most; ++round) {
        if (options.progress) options.progress(static_cast<std::size_t>(round), most);
        readings.samples = averaged(samples, instrument, quadratures.levels);
        readings.veil = quadratures.veil;
        const InstrumentProblem problem(readings, sum, options.loss);
        const Minimum minimum = searched(problem, problem.start(x), options);
        x = minimum.x;
        iterations += minimum.iterations, evaluations += minimum.evaluations;
        setMaterial(problem, x, result);
        if (!quadratures.refine(*openFit(result), samples, instrument)) continue;
        result.converged = minimum.converged;
        result.message = minimum.message;
        result.iterations = iterations;
        result.evaluations = evaluations;
        describeReadings(problem, x, options, result);
        result.instrument = fittedAt(problem, x, quadratures);
        addStatistics(problem, x, result);
        result.samples = samples.size();
        result.values = samples.values.size();
        result.startCount = options.starts;
        result.seed = options.seed;
        result.robustScale = 0;
        if (options.progress) options.progress(most, most);
        return result;
    }
    throw unsettled(most);
}

std::vector<double> readingsOf(const FitResult& result, const FitSamples& samples) {
    const FittedInstrument& fitted = *result.instrument;
    if (!result.laws.empty()) return statedReadings(*openFit(result), samples, fitted.instrument);
    const ParametricSum sum(result.model, samples.isotropic);
    Readings readings{.samples = samples, .instrument = fitted.instrument};
    readings.mix = slitMatrix(fitted.instrument.slit, samples.channels);
    Quadratures quadratures;
    quadratures.levels.resize(samples.size());
    quadratures.refine(*openFit(result), samples, fitted.instrument);
    readings.samples = averaged(samples, fitted.instrument, quadratures.levels);
    readings.veil = std::move(quadratures.veil);
    const InstrumentProblem problem(readings, sum, Loss::Kind::l2);
    std::vector<double> x = problem.start(materialOf(result, sum, samples.channels.count()));
    const auto set = [&](std::optional<std::size_t> place, const std::vector<double>& values) {
        if (place) std::ranges::copy(values, x.begin() + static_cast<std::ptrdiff_t>(*place));
    };
    set(problem.offsetPlace(), fitted.offset);
    set(problem.darkPlace(), fitted.dark);
    set(problem.strayPlace(), {fitted.stray});
    for (const InstrumentProblem::Zero& zero : problem.zeros())
        if (!zero.ofScan)
            set(zero.first, zero.detector ? fitted.detectorZeros : fitted.incidenceZeros);
    problem.setZerosOfScans(x);
    return problem.model(x);
}

std::vector<double> readingsAt(const FitResult& result, const Channels& channels, bool isotropic,
                               std::span<const DirectionPair> pairs) {
    FitSamples samples = unmeasuredSamples(pairs, channels, isotropic);
    samples.origin = SampleOrigin::measured;
    FitResult unscaled = result;
    Instrument& own = unscaled.instrument->instrument;
    own.scales = false;
    for (AngleZero* zero : {&own.incidenceZero, &own.detectorZero})
        if (zero->of == AngleZero::Of::scan) *zero = {};
    return readingsOf(unscaled, samples);
}

}  // namespace hshfit::brdfs
