#include <brdfs/fit/dispersion.h>

#include <brdfs/catalog/metal_spec.h>
#include <brdfs/fit/dispersed_problem.h>
#include <brdfs/fit/dispersed_study.h>
#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/fit_statistics.h>
#include <brdfs/fit/instrument/instrument_fit.h>
#include <brdfs/fit/instrument/quadratures.h>
#include <brdfs/fit/split_models.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

void check(const FitSamples& samples, const FitOptions& options) {
    if (samples.channels.kind != Channels::Kind::spectral)
        throw UsageError(
            "laws over the wavelength, and metals, need data with wavelengths; these have none");
    if (options.perChannel)
        throw UsageError(
            "with laws over the wavelength, free is the law of a shape of its own at each; leave "
            "out the shapes per channel");
    const Instrument& instrument = options.instrument;
    if (!instrument.any()) return;
    checkReadings(samples, options);
    if (instrument.offset.fitted() || instrument.dark.fitted() || instrument.scales ||
        instrument.zeros() || instrument.stray.from != InstrumentTerm::From::nothing)
        throw UsageError(
            "with laws over the wavelength, and metals, the terms of the instrument are apertures, "
            "a bandwidth, and an offset and a dark signal that are numbers; leave out what is "
            "fitted, stray light, scales and zeros");
}

/// The fits of single wavelengths, in x of their problems.
std::vector<std::vector<double>> singleFits(DispersedProblem& problem, const FitOptions& options,
                                            FitResult& result) {
    FitOptions own = options;
    own.robust = Robust::none;
    own.progress = {};
    const std::size_t count = problem.samples().channels.count();
    std::vector<std::vector<double>> points;
    for (std::size_t c = 0; c < count; ++c) {
        const Minimum found = searchMinimum(problem.problemAt(c), own).minimum;
        result.iterations += found.iterations;
        result.evaluations += found.evaluations;
        points.push_back(found.x);
        if (options.progress) options.progress(c + 1, count + 2);
    }
    return points;
}

/// Points of all wavelengths with the shapes of one.
std::vector<std::vector<double>> withShapesOf(DispersedProblem& problem,
                                              const std::vector<double>& leader) {
    std::vector<std::vector<double>> points;
    for (std::size_t c = 0; c < problem.samples().channels.count(); ++c) {
        const std::size_t shapes = problem.problemAt(c).shapeCount();
        std::vector<double> x(leader.begin(), leader.begin() + static_cast<std::ptrdiff_t>(shapes)),
            linear;
        problem.problemAt(c).eliminated(x, false, linear);
        x.insert(x.end(), linear.begin(), linear.end());
        points.push_back(std::move(x));
    }
    return points;
}

Minimum search(DispersedProblem& problem, const FitOptions& options, FitResult& result) {
    const auto single = singleFits(problem, options, result);
    std::vector<Minimum> starts(1);
    starts[0].x = problem.model().nearest(single);
    for (const std::size_t leader : {std::size_t{0}, single.size() / 2, single.size() - 1}) {
        starts.emplace_back();
        starts.back().x = problem.model().nearest(withShapesOf(problem, single[leader]));
    }
    for (Minimum& start : starts) start.cost = problem.joint(start.x, false).cost;
    std::ranges::stable_sort(starts, {}, &Minimum::cost);
    // A search takes many times as long as its start is worth beyond the best two.
    constexpr std::size_t searched = 2;
    Minimum best;
    for (std::size_t i = 0; i < searched; ++i) {
        Minimum found = minimised(problem, starts[i].x,
                                  {.iterations = options.iterations, .limit = options.limit});
        result.iterations += found.iterations;
        result.evaluations += found.evaluations;
        if (best.x.empty() || found.cost < best.cost) best = std::move(found);
        if (options.progress) options.progress(single.size() + i + 1, single.size() + searched);
    }
    if (options.robust == Robust::none) return best;
    result.robustScale = options.robustScale;
    if (!(result.robustScale > 0))
        result.robustScale = robustScaleOf(options.robust, problem.residuals(best.x));
    problem.setRobust(options.robust, result.robustScale);
    best = minimised(problem, best.x, {.iterations = options.iterations, .limit = options.limit});
    result.iterations += best.iterations;
    result.evaluations += best.evaluations;
    return best;
}

/// The material: its specification at each wavelength, and its laws.
void setMaterial(const DispersedModel& model, const std::vector<double>& x, FitResult& result) {
    result.model = model.spec();
    result.spectrum.clear();
    result.laws.clear();
    for (const double nanometres : model.wavelengths())
        result.spectrum.push_back({nanometres, model.specAt(nanometres, x)});
    for (std::size_t i = 0; i < model.parameterCount(); ++i) {
        const auto first = x.begin() + static_cast<std::ptrdiff_t>(model.first(i));
        result.laws.push_back(
            {model.law(i).parameter,
             model.law(i).text(),
             {first, first + static_cast<std::ptrdiff_t>(model.curve(i).count())}});
    }
}

void addStatistics(const std::vector<double>& residuals, const FitSamples& samples,
                   const FitOptions& options, FitResult& result) {
    result.startCount = options.starts;
    result.seed = options.seed;
    result.samples = samples.size();
    result.values = residuals.size();
    double squares = 0, weights = 0;
    for (std::size_t v = 0; v < residuals.size(); ++v) {
        const double weight = samples.weight(v / samples.size(), v % samples.size());
        squares += weight * residuals[v] * residuals[v];
        weights += weight;
    }
    addStatistics(squares, weights, !samples.sigmas.empty(), result);
}

/// States the instrument, and models of values with what it adds.
void addInstrument(const FitSamples& samples, const FitSamples& stated, const FitSamples& readings,
                   const Instrument& instrument, const Quadratures& quadratures,
                   FitResult& result) {
    if (!instrument.any()) return;
    FittedInstrument own;
    own.instrument = instrument;
    const auto of = [&](const InstrumentTerm& term) {
        const bool none = term.from == InstrumentTerm::From::nothing;
        return std::vector<double>(none ? 0 : samples.channels.count(), term.value);
    };
    own.offset = of(instrument.offset);
    own.dark = of(instrument.dark);
    quadratures.describe(readings, own);
    for (std::size_t v = 0; result.uncertainty && v < samples.values.size(); ++v)
        result.uncertainty->values[v].model += samples.values[v] - stated.values[v];
    result.instrument = std::move(own);
}

}  // namespace

bool namesMetals(std::string_view model) {
    return std::ranges::any_of(splitModels(model), [](const std::string& term) {
        return namesMetal(std::string_view(term).substr(std::min(term.find(':') + 1, term.size())));
    });
}

FitResult fitDispersed(const FitSamples& samples, const FitOptions& options) {
    check(samples, options);
    const std::vector<double>& wavelengths = samples.channels.wavelengths;
    const std::vector<LawStatement> laws = options.dispersion.empty()
                                               ? std::vector<LawStatement>{}
                                               : parseDispersion(options.dispersion);
    const DispersedModel model(options.model, samples.isotropic, wavelengths, laws);
    const std::size_t values = samples.size() * wavelengths.size();
    requireValues(options.model, values, model.count());
    const Instrument& instrument = options.instrument;
    const FitSamples stated = withoutStated(samples, instrument);
    const std::vector<double> mix = instrument.slit.finite()
                                        ? slitMatrix(instrument.slit, samples.channels)
                                        : std::vector<double>();
    Quadratures quadratures;
    quadratures.levels.resize(samples.size());
    FitResult result;
    Minimum found;
    constexpr int most = 8;
    for (int round = 0; round < most; ++round) {
        const FitSamples readings = averaged(stated, instrument, quadratures.levels);
        DispersedProblem problem(readings, model, options.loss, mix);
        found = round == 0 ? search(problem, options, result)
                           : minimised(problem, found.x,
                                       {.iterations = options.iterations, .limit = options.limit});
        setMaterial(model, found.x, result);
        if (!quadratures.refine(*openFit(result), samples, instrument)) continue;
        result.converged = found.converged;
        result.message = found.message;
        describeDispersed(problem, found, options, result);
        addStatistics(problem.residuals(found.x), samples, options, result);
        addInstrument(samples, stated, readings, instrument, quadratures, result);
        return result;
    }
    throw unsettled(most);
}

}  // namespace hshfit::brdfs
