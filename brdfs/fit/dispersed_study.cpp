#include <brdfs/fit/dispersed_study.h>

#include <brdfs/fit/correlated_spread.h>
#include <brdfs/fit/covariance.h>
#include <brdfs/fit/dense.h>
#include <brdfs/fit/dispersed_profile.h>
#include <brdfs/fit/fit_statistics.h>
#include <brdfs/fit/held_by_bounds.h>
#include <brdfs/fit/minimum_study.h>
#include <brdfs/fit/propagated_errors.h>
#include <brdfs/fit/resampling.h>
#include <brdfs/fit/scan_spread.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

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
    const std::vector<std::string> names = problem.samples().channels.names();
    result.point.draws.assign(options.uncertainty.bootstrap, {});
    const auto refit = [&](std::size_t b) {
        const FitSamples own = redrawn(problem.samples(), options.seed, b);
        const DispersedProblem again(own, model, options.loss, problem.mix());
        const Minimum one = minimised(again, found.x, {});
        std::vector<double> values;
        if (!one.converged) return values;
        for (const FittedParameter& parameter : reportOf(model, one.x, names).parameters)
            values.push_back(parameter.value);
        result.point.draws[b] = valuesAt(model, one.x, nullptr);
        return values;
    };
    addBootstrap(refit, options.uncertainty, *result.uncertainty);
}

/// Errors of the parameters by all routes but the bootstrap.
void addErrors(const Report& report, const Covariance& independent, const Covariance& covariance,
               const std::vector<double>& normal, const std::vector<double>& degrees,
               const std::vector<bool>& fixed, FitResult& result) {
    const std::size_t n = fixed.size();
    const std::vector<bool> known = determined(report, covariance, fixed);
    const Matrix whole =
        report.slopes * squareMatrix(covariance.whole, n) * report.slopes.transpose();
    const Matrix sandwich =
        report.slopes * squareMatrix(independent.whole, n) * report.slopes.transpose();
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
    const Matrix stated =
        scale * report.slopes * squareMatrix(normal, n) * report.slopes.transpose();
    uncertainty.parameters.resize(n);
    uncertainty.covariance.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        if (!known[i]) continue;
        ParameterUncertainty& own = uncertainty.parameters[i];
        for (std::size_t j = 0; j < n; ++j)
            if (known[j]) uncertainty.covariance[i * n + j] = stated(at(i), at(j));
        own.normal = std::sqrt(std::max(0.0, stated(at(i), at(i))));
        own.sandwich = std::sqrt(std::max(0.0, sandwich(at(i), at(i))));
        if (uncertainty.correlated) own.correlated = *result.parameters[i].standardError;
        if (uncertainty.scans == 0) continue;
        own.scans = *result.parameters[i].standardError;
        if (degrees[i] > 0) own.scanDegrees = degrees[i];
    }
}

CommonChanges changesOf(const DispersedProblem& problem, const std::vector<double>& x,
                        const WeightedRows& rows, const Matrix& inverse, const Report& report,
                        const FitOptions& options) {
    const FitSamples& samples = problem.samples();
    CommonChanges changes;
    for (const Contribution& contribution : options.contributions) {
        const std::vector<double> shift = shiftOf(
            contribution, samples, options.instrument.darkOver, [&](const FitSamples& turned) {
                return DispersedProblem(turned, problem.model(), options.loss, problem.mix())
                    .weightedRows(x)
                    .values;
            });
        const Eigen::VectorXd own =
            inverse * pullOf(rows, shift, samples, options.loss, x.size(), 0);
        const Eigen::VectorXd reported = report.slopes * own;
        changes.coefficients.emplace_back(own.begin(), own.end());
        changes.parameters.emplace_back(reported.begin(), reported.end());
    }
    return changes;
}

}  // namespace

Minimum minimised(const DispersedProblem& problem, std::vector<double> start,
                  const MinimiseOptions& options) {
    const DispersedModel& model = problem.model();
    for (std::size_t j = 0; j < start.size(); ++j)
        start[j] = std::clamp(start[j], model.lower()[j], model.upper()[j]);
    return minimise(
        [&](std::span<const double> x, bool derivatives) { return problem.joint(x, derivatives); },
        std::move(start), model.lower(), model.upper(), options);
}

void describeDispersed(const DispersedProblem& problem, const Minimum& found,
                       const FitOptions& options, FitResult& result) {
    const DispersedModel& model = problem.model();
    const FitSamples& samples = problem.samples();
    const std::size_t n = found.x.size();
    Equations equations = problem.joint(found.x, true);
    Report report = reportOf(model, found.x, samples.channels.names());
    const HeldByBounds held = heldByBounds(found.x, equations, {model.lower(), model.upper()});
    const std::vector<bool>& fixed = held.fixed;
    result.projectedGradient = held.projectedGradient;
    // A bound of a coefficient is one of the parameter that is this coefficient alone.
    for (std::size_t j = 0; j < n; ++j)
        if ((report.slopes.row(at(j)).array() != 0).count() == 1)
            report.parameters[j].bound = held.bound[j];
    result.parameters = report.parameters;
    const std::vector<double> inverse = inverseOf(equations, fixed);
    equations.spread = problem.joint(found.x, true, inverse).spread;
    Covariance covariance = covarianceOf(equations, fixed);
    const Covariance independent = covariance;
    const bool correlated = samples.correlation.any();
    const bool byScan = !samples.scans.empty() && !correlated;
    const Matrix unscaled = squareMatrix(inverse, n) / problem.normalisation();
    const bool common = !options.contributions.empty();
    const WeightedRows rows = options.uncertainty.report || byScan || common || correlated
                                  ? problem.weightedRows(found.x)
                                  : WeightedRows{};
    std::vector<double> degrees;
    if (byScan) {
        const double square = problem.normalisation() * problem.normalisation();
        const std::vector<ScanSums> sums = sumsOfScans(rows, samples.scans, n, 0);
        requireScans(sums.size(), model.parameterCount(), false);
        const Matrix spread = scanSpread(sums, unscaled) / square;
        degrees = scanDegrees(sums, unscaled, report.slopes);
        result.point.freedom.push_back({0, std::make_shared<const VarianceFreedom>(
                                               sums, unscaled, Eigen::VectorXd::Ones(at(n)))});
        equations.spread.assign(spread.data(), spread.data() + spread.size());
        covariance = covarianceOf(equations, fixed);
    }
    if (correlated) {
        const Matrix spread = correlatedSpread(samples, rows, n, 0) /
                              (problem.normalisation() * problem.normalisation());
        equations.spread.assign(spread.data(), spread.data() + spread.size());
        covariance = covarianceOf(equations, fixed);
    }
    if (options.uncertainty.report)
        result.uncertainty =
            influences({.residuals = rows.residuals,
                        .models = rows.values,
                        .leverages = leveragesOf(rows, unscaled, 0),
                        .stated = !samples.sigmas.empty(),
                        .correlated = correlated,
                        .scans = byScan ? *std::ranges::max_element(samples.scans) + 1 : 0});
    std::vector<double> normal = inverse;
    for (double& value : normal) value /= problem.normalisation();
    addErrors(report, independent, covariance, normal, degrees, fixed, result);
    result.ambiguous = labelsOf(covariance.ambiguous, result.parameters);
    result.point.isotropic = samples.isotropic;
    result.point.covariance = covariance.whole;
    valuesAt(model, found.x, &result.point);
    if (common) {
        constexpr double known = std::numeric_limits<double>::infinity();
        const double freedom = static_cast<double>(rows.samples) - static_cast<double>(n);
        addBudget(
            options.contributions, changesOf(problem, found.x, rows, unscaled, report, options),
            byScan ? degrees : std::vector<double>(n, correlated ? known : std::max(1.0, freedom)),
            result);
    }
    if (options.uncertainty.bootstrap > 0) addDraws(problem, found, options, result);
    if (options.uncertainty.profile)
        addProfiles(problem, found.x, fixed, options.uncertainty, *result.uncertainty);
}

}  // namespace hshfit::brdfs
