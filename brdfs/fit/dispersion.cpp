#include <brdfs/fit/dispersion.h>

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/dispersed_problem.h>
#include <brdfs/fit/dispersed_profile.h>
#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/fit_statistics.h>
#include <brdfs/fit/minimum_study.h>
#include <brdfs/fit/percentiles.h>
#include <brdfs/fit/resampling.h>
#include <brdfs/fit/scan_spread.h>
#include <brdfs/fit/split_models.h>
#include <brdfs/metal_spec.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Matrix = Eigen::MatrixXd;

Eigen::Index at(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

void check(const FitSamples& samples, const FitOptions& options) {
    if (samples.channels.kind != Channels::Kind::spectral)
        throw UsageError(
            "laws over the wavelength, and metals, need data with wavelengths; these have none");
    if (options.perChannel)
        throw UsageError(
            "with laws over the wavelength, free is the law of a shape of its own at each; leave "
            "out the shapes per channel");
}

Minimum minimum(const DispersedProblem& problem, std::vector<double> start,
                const MinimiseOptions& options) {
    const DispersedModel& model = problem.model();
    for (std::size_t j = 0; j < start.size(); ++j)
        start[j] = std::clamp(start[j], model.lower()[j], model.upper()[j]);
    return minimise(
        [&](std::span<const double> x, bool derivatives) { return problem.joint(x, derivatives); },
        std::move(start), model.lower(), model.upper(), options);
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
        Minimum found = minimum(problem, starts[i].x, {.iterations = options.iterations});
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
    best = minimum(problem, best.x, {.iterations = options.iterations});
    result.iterations += best.iterations;
    result.evaluations += best.evaluations;
    return best;
}

/// The parameters that a report states, one for each coefficient.
struct Report {
    std::vector<FittedParameter> parameters;
    Matrix slopes;  ///< of the parameters by the coefficients
};

Report reportOf(const DispersedModel& model, const std::vector<double>& coefficients,
                const std::vector<std::string>& channels) {
    const ParametricSum& sum = model.sum(0);
    const std::size_t n = coefficients.size();
    Report report;
    report.slopes = Matrix::Zero(at(n), at(n));
    for (std::size_t i = 0; i < model.parameterCount(); ++i) {
        const LawCurve& curve = model.curve(i);
        const LawStatement& law = model.law(i);
        const std::size_t first = model.first(i);
        const auto own = curve.reported({coefficients.data() + first, curve.count()});
        const bool shape = i < sum.shapes().size();
        const bool index = model.ofIndex(i);
        for (std::size_t k = 0; k < curve.count(); ++k) {
            FittedParameter parameter;
            parameter.name = law.parameter + own.names[k];
            if (law.kind == DispersionLaw::Kind::free) parameter.channel = channels[k];
            parameter.linear = !shape;
            parameter.value = own.values[k];
            double slope = 1;
            if (shape && !index) {
                parameter.value = sum.shapes()[i].toValue(own.values[k]);
                slope = sum.shapes()[i].slope(parameter.value);
            }
            for (std::size_t j = 0; j < curve.count(); ++j)
                report.slopes(at(first + k), at(first + j)) =
                    slope * own.slopes[k * curve.count() + j];
            report.parameters.push_back(std::move(parameter));
        }
    }
    return report;
}

/// The coefficients that a bound holds; names it where a parameter is that coefficient.
std::vector<bool> heldBy(const DispersedModel& model, const std::vector<double>& x,
                         const Equations& equations, Report& report, double& projected) {
    std::vector<bool> fixed;
    const std::size_t n = x.size();
    for (std::size_t j = 0; j < n; ++j) {
        const double reach = 1e-9 * (1 + std::abs(x[j])), pull = equations.gradient[j];
        std::string bound;
        if (x[j] <= model.lower()[j] + reach && pull >= 0) bound = "lower";
        if (x[j] >= model.upper()[j] - reach && pull <= 0) bound = "upper";
        const double scale = std::sqrt(std::max(equations.hessian[j * n + j], 0.0));
        const double negligible = 1e-6 * std::sqrt(2 * equations.cost) + 1e-12;
        fixed.push_back(!bound.empty() && std::abs(pull) > negligible * scale);
        if (!fixed[j] && scale > 0) projected = std::max(projected, std::abs(pull) / scale);
        const bool alone = (report.slopes.row(at(j)).array() != 0).count() == 1;
        if (alone) report.parameters[j].bound = bound;
    }
    return fixed;
}

Matrix mapped(const std::vector<double>& matrix, std::size_t n) {
    return Eigen::Map<const Matrix>(matrix.data(), at(n), at(n));
}

/// Whether the data determine a parameter: every coefficient that it depends on, but for those that
/// bounds hold, and at least one.
std::vector<bool> determined(const Report& report, const Covariance& covariance,
                             const std::vector<bool>& fixed) {
    std::vector<bool> result;
    for (Eigen::Index i = 0; i < report.slopes.rows(); ++i) {
        bool all = true, any = false;
        for (Eigen::Index j = 0; j < report.slopes.cols(); ++j) {
            const auto k = static_cast<std::size_t>(j);
            if (report.slopes(i, j) == 0 || fixed[k]) continue;
            any = true;
            all = all && covariance.variance[k] >= 0;
        }
        result.push_back(all && any);
    }
    return result;
}

/// Values of the parameters of a sum at each wavelength, for predictions.
std::vector<std::vector<double>> valuesAt(const DispersedModel& model,
                                          const std::vector<double>& coefficients,
                                          FittedPoint* point) {
    std::vector<std::vector<double>> all;
    for (std::size_t c = 0; c < model.wavelengths().size(); ++c) {
        Matrix slopes;
        std::vector<double> values = model.pointAt(c, coefficients, point ? &slopes : nullptr);
        const ParametricSum& sum = model.sum(c);
        FittedChannel channel{
            sum.spec(), {}, std::vector<std::vector<FittedChannel::Slope>>(values.size())};
        for (std::size_t i = 0; i < values.size(); ++i) {
            double slope = 1;
            if (i < sum.shapes().size()) {
                values[i] = sum.shapes()[i].toValue(values[i]);
                slope = sum.shapes()[i].slope(values[i]);
            }
            for (Eigen::Index j = 0; point && j < slopes.cols(); ++j)
                if (slopes(at(i), j) != 0)
                    channel.slopes[i].push_back(
                        {static_cast<std::size_t>(j), slope * slopes(at(i), j)});
        }
        if (point) {
            channel.values = values;
            point->channels.push_back(std::move(channel));
        }
        all.push_back(std::move(values));
    }
    return all;
}

void addDraws(const DispersedProblem& problem, const Minimum& found, const FitOptions& options,
              FitResult& result) {
    const DispersedModel& model = problem.model();
    const std::size_t count = options.uncertainty.bootstrap;
    const std::vector<std::string> names = problem.samples().channels.names();
    std::vector<std::vector<double>> draws(count);
    result.point.draws.assign(count, {});
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t b) {
        const FitSamples own = redrawn(problem.samples(), options.seed, b);
        const DispersedProblem again(own, model, options.loss);
        const Minimum one = minimum(again, found.x, {});
        if (one.converged) {
            for (const FittedParameter& parameter : reportOf(model, one.x, names).parameters)
                draws[b].push_back(parameter.value);
            result.point.draws[b] = valuesAt(model, one.x, nullptr);
        }
        if (options.uncertainty.progress) options.uncertainty.progress(++done, count);
    });
    Uncertainty& uncertainty = *result.uncertainty;
    uncertainty.bootstrapDraws = count;
    std::size_t converged = 0;
    for (const auto& draw : draws) converged += !draw.empty();
    uncertainty.bootstrapFailures = count - converged;
    if (converged < 2)
        throw NumericError(fmt::format(
            "{} of {} fits to resampled data converged; expected at least 2", converged, count));
    for (std::size_t i = 0; i < result.parameters.size(); ++i) {
        std::vector<double> values;
        for (const auto& draw : draws)
            if (!draw.empty()) values.push_back(draw[i]);
        uncertainty.parameters[i].bootstrap = summarised(std::move(values));
    }
    uncertainty.draws = std::move(draws);
}

/// Errors of the parameters by all routes but the bootstrap.
void addErrors(const Report& report, const Covariance& independent, const Covariance& covariance,
               const std::vector<double>& normal, const std::vector<double>& degrees,
               const std::vector<bool>& fixed, FitResult& result) {
    const std::size_t n = fixed.size();
    const std::vector<bool> known = determined(report, covariance, fixed);
    const Matrix whole = report.slopes * mapped(covariance.whole, n) * report.slopes.transpose();
    const Matrix sandwich =
        report.slopes * mapped(independent.whole, n) * report.slopes.transpose();
    result.correlations.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        if (!known[i]) continue;
        result.parameters[i].standardError = std::sqrt(std::max(0.0, whole(at(i), at(i))));
        for (std::size_t j = 0; j < n; ++j) {
            const double size = std::sqrt(whole(at(i), at(i)) * whole(at(j), at(j)));
            if (known[j] && size > 0) result.correlations[i * n + j] = whole(at(i), at(j)) / size;
        }
    }
    if (!result.uncertainty) return;
    Uncertainty& uncertainty = *result.uncertainty;
    const double scale = uncertainty.stated ? 1 : uncertainty.reducedChiSquare();
    const Matrix stated = scale * report.slopes * mapped(normal, n) * report.slopes.transpose();
    uncertainty.parameters.resize(n);
    uncertainty.covariance.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        if (!known[i]) continue;
        ParameterUncertainty& own = uncertainty.parameters[i];
        for (std::size_t j = 0; j < n; ++j)
            if (known[j]) uncertainty.covariance[i * n + j] = stated(at(i), at(j));
        own.normal = std::sqrt(std::max(0.0, stated(at(i), at(i))));
        own.sandwich = std::sqrt(std::max(0.0, sandwich(at(i), at(i))));
        if (uncertainty.scans == 0) continue;
        own.scans = *result.parameters[i].standardError;
        if (degrees[i] > 0) own.scanDegrees = degrees[i];
    }
}

using Slopes = Eigen::Map<const Eigen::VectorXd>;

std::vector<double> leveragesOf(const WeightedRows& rows, const Matrix& inverse) {
    std::vector<double> leverages;
    for (std::size_t v = 0; v < rows.samples; ++v) {
        const Slopes slopes(rows.slopes.data() + v * rows.columns, at(rows.columns));
        leverages.push_back(slopes.dot(inverse * slopes));
    }
    return leverages;
}

std::vector<ScanSums> sumsOfScans(const WeightedRows& rows, const std::vector<std::size_t>& scans,
                                  std::size_t n) {
    const std::size_t count = *std::ranges::max_element(scans) + 1;
    std::vector<ScanSums> sums(count, {Matrix::Zero(at(n), at(n)), Eigen::VectorXd::Zero(at(n))});
    for (std::size_t v = 0; v < rows.samples; ++v) {
        const Slopes slopes(rows.slopes.data() + v * rows.columns, at(n));
        ScanSums& scan = sums[scans[v % scans.size()]];
        scan.gradient += rows.residuals[v] * slopes;
        scan.matrix += slopes * slopes.transpose();
    }
    return sums;
}

void describe(const DispersedProblem& problem, const Minimum& found, const FitOptions& options,
              FitResult& result) {
    const DispersedModel& model = problem.model();
    const FitSamples& samples = problem.samples();
    const std::size_t n = found.x.size();
    Equations equations = problem.joint(found.x, true);
    Report report = reportOf(model, found.x, samples.channels.names());
    const std::vector<bool> fixed =
        heldBy(model, found.x, equations, report, result.projectedGradient);
    result.parameters = report.parameters;
    const std::vector<double> inverse = inverseOf(equations, fixed);
    equations.spread = problem.joint(found.x, true, inverse).spread;
    Covariance covariance = covarianceOf(equations, fixed);
    const Covariance independent = covariance;
    const bool byScan = !samples.scans.empty();
    const Matrix unscaled = mapped(inverse, n) / problem.normalisation();
    const WeightedRows rows =
        options.uncertainty.report || byScan ? problem.weightedRows(found.x) : WeightedRows{};
    std::vector<double> degrees;
    if (byScan) {
        const double square = problem.normalisation() * problem.normalisation();
        const std::vector<ScanSums> sums = sumsOfScans(rows, samples.scans, n);
        requireScans(sums.size(), model.parameterCount(), false);
        const Matrix spread = scanSpread(sums, unscaled) / square;
        degrees = scanDegrees(sums, unscaled, report.slopes);
        result.point.freedom.push_back({0, std::make_shared<const VarianceFreedom>(
                                               sums, unscaled, Eigen::VectorXd::Ones(at(n)))});
        equations.spread.assign(spread.data(), spread.data() + spread.size());
        covariance = covarianceOf(equations, fixed);
    }
    if (options.uncertainty.report)
        result.uncertainty =
            influences({.residuals = rows.residuals,
                        .models = rows.values,
                        .leverages = leveragesOf(rows, unscaled),
                        .stated = !samples.sigmas.empty(),
                        .scans = byScan ? *std::ranges::max_element(samples.scans) + 1 : 0});
    std::vector<double> normal = inverse;
    for (double& value : normal) value /= problem.normalisation();
    addErrors(report, independent, covariance, normal, degrees, fixed, result);
    for (const auto& set : covariance.ambiguous) {
        result.ambiguous.emplace_back();
        for (const std::size_t i : set) {
            const FittedParameter& own = result.parameters[i];
            result.ambiguous.back().push_back(
                own.channel.empty() ? own.name : fmt::format("{} {}", own.name, own.channel));
        }
    }
    result.point.isotropic = samples.isotropic;
    result.point.covariance = covariance.whole;
    valuesAt(model, found.x, &result.point);
    if (options.uncertainty.bootstrap > 0) addDraws(problem, found, options, result);
    if (options.uncertainty.profile)
        addProfiles(problem, found.x, fixed, options.uncertainty, *result.uncertainty);
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
    DispersedProblem problem(samples, model, options.loss);
    const std::size_t values = samples.size() * wavelengths.size();
    if (values < model.count())
        throw NumericError(
            fmt::format("'{}': {} values cannot determine {} free parameters; give some of them, "
                        "or more samples",
                        options.model, values, model.count()));
    FitResult result;
    const Minimum found = search(problem, options, result);
    result.converged = found.converged;
    result.message = found.message;
    describe(problem, found, options, result);
    result.model = options.model;
    for (const double nanometres : wavelengths)
        result.spectrum.push_back({nanometres, model.specAt(nanometres, found.x)});
    for (std::size_t i = 0; i < model.parameterCount(); ++i) {
        const auto first = found.x.begin() + static_cast<std::ptrdiff_t>(model.first(i));
        result.laws.push_back(
            {model.law(i).parameter,
             model.law(i).text(),
             {first, first + static_cast<std::ptrdiff_t>(model.curve(i).count())}});
    }
    result.startCount = options.starts;
    result.seed = options.seed;
    result.samples = samples.size();
    result.values = values;
    const std::vector<double> residuals = problem.residuals(found.x);
    double squares = 0, weights = 0;
    for (std::size_t v = 0; v < residuals.size(); ++v) {
        const double weight = samples.weight(v / samples.size(), v % samples.size());
        squares += weight * residuals[v] * residuals[v];
        weights += weight;
    }
    addStatistics(squares, weights, !samples.sigmas.empty(), result);
    return result;
}

}  // namespace hshfit::brdfs
