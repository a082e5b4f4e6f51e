#include <brdfs/fit/material_fit.h>

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/distributions.h>
#include <brdfs/fit/filled_in.h>
#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/fit_statistics.h>
#include <brdfs/fit/held_by_bounds.h>
#include <brdfs/fit/minimum_study.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/parametric_sum.h>
#include <brdfs/fit/propagated_errors.h>
#include <brdfs/fit/scan_spread.h>
#include <brdfs/fit/unseen_lobes.h>
#include <brdfs/fit/whitening.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

/// A fit of channels that share their shapes.
struct Part {
    FitResult result;  ///< without spec
    std::vector<double> shapes, linear;
    std::vector<double> covariance;  ///< of all values: FittedPoint
    std::shared_ptr<const VarianceFreedom> freedom;
    std::vector<std::vector<double>> changes;  ///< CommonChanges::parameters
    std::vector<double> degrees;               ///< of the standard errors, with changes
    double squares = 0, weights = 0;
    double chiSquare = 0;  ///< `squares` of independent values
};

/// Sets what contributions change, and the degrees of freedom beside them.
void addChanges(const FitProblem& problem, const std::vector<double>& x,
                const std::vector<double>& inverse, const std::vector<double>& slope,
                const FitOptions& options, Part& part) {
    if (options.contributions.empty()) return;
    const auto n = static_cast<Eigen::Index>(x.size());
    const FitSamples& samples = problem.samples();
    const Eigen::Map<const Eigen::MatrixXd> own(inverse.data(), n, n);
    const WeightedRows rows = problem.weightedRows(x);
    for (const Contribution& contribution : options.contributions) {
        const std::vector<double> shift =
            shiftOf(contribution, samples, options.instrument.darkOver, [&](FitSamples turned) {
                turned.correlation = {};
                return FitProblem(turned, problem.sum(), problem.loss()).values(x);
            });
        const Eigen::VectorXd change =
            own *
            pullOf(rows, rows.whitened ? problem.weighted(shift) : shift, samples, problem.loss(),
                   x.size(), problem.shapeCount()) /
            problem.normalisation();
        part.changes.emplace_back(change.begin(), change.end());
        for (std::size_t i = 0; i < x.size(); ++i) part.changes.back()[i] *= slope[i];
    }
    constexpr double known = std::numeric_limits<double>::infinity();
    // Without `freedom`, errors follow from stated uncertainties or from very many values.
    part.degrees.assign(x.size(), known);
    if (!part.freedom) return;
    part.degrees = part.freedom->degrees(Eigen::MatrixXd::Identity(n, n));
    for (double& degrees : part.degrees) degrees = degrees > 0 ? std::max(degrees, 1.0) : known;
}

void describe(const FitProblem& problem, const std::vector<double>& x, const FitOptions& options,
              Part& part) {
    const ParametricSum& sum = problem.sum();
    const std::size_t shapes = problem.shapeCount(), channels = problem.channels();
    const Bounds bounds = jointBounds(sum, channels);
    Equations equations = problem.joint(x, true);
    const HeldByBounds held = heldByBounds(x, equations, bounds);
    const std::vector<bool>& fixed = held.fixed;
    part.result.projectedGradient = held.projectedGradient;
    std::vector<double> slope;  // of the value by x
    std::vector<FittedParameter>& parameters = part.result.parameters;
    const std::vector<std::string> names = problem.samples().channels.names();
    for (std::size_t i = 0; i < x.size(); ++i) {
        FittedParameter parameter;
        parameter.bound = held.bound[i];
        const double at = parameter.bound == "lower"   ? bounds.lower[i]
                          : parameter.bound == "upper" ? bounds.upper[i]
                                                       : x[i];
        if (i < shapes) {
            const ShapeParameter& shape = sum.shapes()[i];
            parameter.name = shape.name;
            parameter.value = shape.free.reduced(shape.toValue(at));
            slope.push_back(shape.slope(parameter.value));
            part.shapes.push_back(parameter.value);
        } else {
            const std::size_t k = (i - shapes) / channels, c = (i - shapes) % channels;
            parameter.name = sum.linears()[k].name;
            parameter.channel = names.size() > 1 ? names[c] : "";
            parameter.value = at;
            parameter.linear = sum.linears()[k].exact;
            slope.push_back(1);
            part.linear.push_back(at);
        }
        parameters.push_back(std::move(parameter));
    }
    const std::vector<double> inverse = inverseOf(equations, fixed);
    equations.spread = problem.joint(x, true, inverse).spread;
    Covariance covariance = covarianceOf(equations, fixed);
    const Covariance sandwich = covariance;
    part.freedom = freedomAt(problem, x, inverse, slope);
    if (problem.samples().correlation.any()) {
        equations.spread = equations.hessian;
        for (double& value : equations.spread) value /= problem.normalisation();
        covariance = covarianceOf(equations, fixed);
        part.freedom.reset();
    } else if (!problem.samples().scans.empty()) {
        equations.spread = spreadOfScans(problem, *part.freedom, equations);
        covariance = covarianceOf(equations, fixed);
        if (!scansSuffice(problem, *part.freedom)) part.freedom.reset();
    }
    addChanges(problem, x, inverse, slope, options, part);
    part.covariance = covarianceOfValues(covariance, slope);
    reportUnseenLobes(
        {shapes, channels, shapes + problem.linearCount()},
        [&](std::span<const double> at) { return problem.joint(at, true); }, x, equations, fixed,
        covariance);
    stateErrors(covariance, slope, part.result);
    if (!options.uncertainty.report) return;
    const StudiedMinimum minimum{problem, x,          equations, fixed,
                                 slope,   covariance, sandwich,  part.freedom.get()};
    part.result.uncertainty = studied(minimum);
    if (options.uncertainty.bootstrap > 0)
        addBootstrap(minimum, options.uncertainty, options.seed, *part.result.uncertainty);
    if (options.uncertainty.profile)
        addProfiles(minimum, options.uncertainty, *part.result.uncertainty);
}

Part fitShared(const FitSamples& samples, const ParametricSum& sum, const FitOptions& options) {
    FitProblem problem(samples, sum, options.loss);
    const std::size_t parameters = problem.shapeCount() + problem.linearCount();
    const std::size_t values = samples.size() * problem.channels();
    requireValues(sum.spec(), values, parameters);
    if (problem.whitening() && values * parameters > Whitening::most)
        throw UsageError(fmt::format(
            "{} values of correlated errors with {} parameters are more than a fit holds in "
            "memory ({} derivatives): take fewer samples, or leave out the correlation",
            values, parameters, Whitening::most));
    const Fitted fitted = searchMinimum(problem, options);
    Part part;
    describe(problem, fitted.minimum.x, options, part);
    FitResult& result = part.result;
    result.converged = fitted.minimum.converged;
    result.message = fitted.minimum.message;
    result.iterations = fitted.minimum.iterations;
    result.evaluations = fitted.minimum.evaluations;
    result.robustScale = fitted.robustScale;
    const std::vector<double> residuals = problem.residuals(fitted.minimum.x);
    for (std::size_t k = 0; k < residuals.size(); ++k) {
        const double weight = samples.weight(k / samples.size(), k % samples.size());
        part.squares += weight * residuals[k] * residuals[k];
        part.weights += weight;
    }
    part.chiSquare =
        problem.whitening() ? 2 * fitted.minimum.cost * problem.normalisation() : part.squares;
    return part;
}

/// Adds the study of a part whose parameters begin at `first` of n.
void addStudy(const Uncertainty& own, std::size_t first, std::size_t n,
              std::optional<Uncertainty>& sum) {
    if (!sum) {
        sum.emplace();
        sum->stated = own.stated;
        sum->correlated = own.correlated;
        sum->whitened = own.whitened;
        sum->scans = own.scans;
        sum->scanParameters = own.scanParameters;
        sum->covariance.assign(n * n, 0);
    }
    sum->chiSquare += own.chiSquare;
    sum->degreesOfFreedom += own.degreesOfFreedom;
    if (own.probability)
        sum->probability =
            chiSquareProbability(sum->chiSquare, static_cast<double>(sum->degreesOfFreedom));
    const std::size_t count = own.parameters.size();
    sum->parameters.insert(sum->parameters.end(), own.parameters.begin(), own.parameters.end());
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j)
            sum->covariance[(first + i) * n + first + j] = own.covariance[i * count + j];
    sum->values.insert(sum->values.end(), own.values.begin(), own.values.end());
    sum->outlierBound = std::max(sum->outlierBound, own.outlierBound);
    sum->bootstrapDraws = own.bootstrapDraws;
    sum->bootstrapFailures += own.bootstrapFailures;
}

/// Puts the fits of single channels together.
FitResult merged(std::vector<Part>& parts, const std::vector<std::string>& names) {
    FitResult result;
    result.converged = true;
    std::size_t n = 0;
    for (const Part& part : parts) n += part.result.parameters.size();
    result.correlations.assign(n * n, 0);
    std::size_t first = 0;
    for (std::size_t c = 0; c < parts.size(); ++c) {
        FitResult& own = parts[c].result;
        const std::size_t count = own.parameters.size();
        for (FittedParameter& parameter : own.parameters) {
            if (parts.size() > 1) parameter.channel = names[c];
            result.parameters.push_back(parameter);
        }
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j)
                result.correlations[(first + i) * n + first + j] = own.correlations[i * count + j];
        for (auto& set : own.ambiguous) {
            if (parts.size() > 1)
                for (std::string& name : set) name += " " + names[c];
            result.ambiguous.push_back(set);
        }
        if (result.converged) result.message = own.message;
        result.converged = result.converged && own.converged;
        result.iterations += own.iterations;
        result.evaluations += own.evaluations;
        result.projectedGradient = std::max(result.projectedGradient, own.projectedGradient);
        result.robustScale = std::max(result.robustScale, own.robustScale);
        if (own.uncertainty) addStudy(*own.uncertainty, first, n, result.uncertainty);
        first += count;
    }
    return result;
}

/// The values of one channel of a part, from a list of all its parameters.
std::vector<double> valuesOfChannel(const std::vector<double>& all, std::size_t shapes,
                                    std::size_t channels, std::size_t c) {
    std::vector<double> values(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(shapes));
    for (std::size_t i = shapes + c; i < all.size(); i += channels) values.push_back(all[i]);
    return values;
}

/// Where predictions are linearised: parts of one channel each, or one of all.
FittedPoint pointOf(const std::vector<Part>& parts, const ParametricSum& sum,
                    const FitSamples& samples) {
    FittedPoint point;
    point.isotropic = samples.isotropic;
    const std::size_t shapes = sum.shapes().size();
    const std::size_t channels = samples.channels.count() / parts.size();
    std::size_t n = 0, first = 0;
    for (const Part& part : parts) n += part.result.parameters.size();
    point.covariance.assign(n * n, 0);
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const Part& part = parts[p];
        const std::size_t count = part.result.parameters.size();
        if (part.freedom) point.freedom.push_back({first, part.freedom});
        std::vector<double> all = part.shapes;
        all.insert(all.end(), part.linear.begin(), part.linear.end());
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j)
                point.covariance[(first + i) * n + first + j] = part.covariance[i * count + j];
        for (std::size_t c = 0; c < channels; ++c) {
            FittedChannel channel{sum.spec(),
                                  valuesOfChannel(all, shapes, channels, c),
                                  {},
                                  p * channels + c,
                                  sum.coloured()};
            for (std::size_t i = 0; i < channel.values.size(); ++i)
                channel.slopes.push_back(
                    {{first + (i < shapes ? i : shapes + (i - shapes) * channels + c), 1}});
            point.channels.push_back(std::move(channel));
        }
        if (part.result.uncertainty) {
            const auto& draws = part.result.uncertainty->draws;
            point.draws.resize(std::max(point.draws.size(), draws.size()));
            for (std::size_t b = 0; b < draws.size(); ++b) {
                // A draw in which one part did not converge stays empty.
                if (draws[b].empty() || point.draws[b].size() != p * channels) {
                    point.draws[b].clear();
                    continue;
                }
                for (std::size_t c = 0; c < channels; ++c)
                    point.draws[b].push_back(valuesOfChannel(draws[b], shapes, channels, c));
            }
        }
        first += count;
    }
    return point;
}

/// The budget of parts together.
void addBudget(const std::vector<Part>& parts, const FitOptions& options, FitResult& result) {
    CommonChanges changes;
    changes.parameters.resize(options.contributions.size());
    std::vector<double> degrees;
    for (const Part& part : parts) {
        for (std::size_t j = 0; j < part.changes.size(); ++j)
            changes.parameters[j].insert(changes.parameters[j].end(), part.changes[j].begin(),
                                         part.changes[j].end());
        degrees.insert(degrees.end(), part.degrees.begin(), part.degrees.end());
    }
    addBudget(options.contributions, changes, degrees, result);
}

}  // namespace

FitResult fitMaterial(const FitSamples& samples, const FitOptions& options, bool coloured) {
    const ParametricSum sum(options.model, samples.isotropic, 0,
                            coloured && samples.channels.count() > 1);
    if (!options.from.empty() && options.from.size() != sum.shapes().size())
        throw UsageError(fmt::format("'{}' has {} shapes, and {} values to start from were given",
                                     sum.spec(), sum.shapes().size(), options.from.size()));
    const std::size_t channels = samples.channels.count();
    const bool apart = options.perChannel && channels > 1;
    std::vector<Part> parts;
    for (std::size_t c = 0; c < (apart ? channels : 1); ++c)
        parts.push_back(fitShared(apart ? samples.channel(c) : samples, sum, options));
    FitResult result = merged(parts, samples.channels.names());

    std::vector<std::vector<double>> shapes;
    for (const Part& part : parts) shapes.push_back(part.shapes);
    std::vector<double> linear = parts.front().linear;
    if (apart) {
        linear.assign(sum.linears().size() * channels, 0);
        for (std::size_t k = 0; k < sum.linears().size(); ++k)
            for (std::size_t c = 0; c < channels; ++c)
                linear[k * channels + c] = parts[c].linear[k];
    }
    result.model = sum.spec();
    result.point = pointOf(parts, sum, samples);
    addBudget(parts, options, result);
    fillIn(sum, shapes, linear, samples.channels, result);
    result.startCount = options.starts;
    result.seed = options.seed;
    result.samples = samples.size();
    result.values = samples.size() * channels;
    double squares = 0, weights = 0, chiSquare = 0;
    for (const Part& part : parts)
        squares += part.squares, weights += part.weights, chiSquare += part.chiSquare;
    addStatistics(squares, weights, !samples.sigmas.empty(), result);
    result.aic += chiSquare - squares, result.bic += chiSquare - squares;
    return result;
}

}  // namespace hshfit::brdfs
