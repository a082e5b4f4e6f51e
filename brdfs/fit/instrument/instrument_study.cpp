#include <brdfs/fit/instrument/instrument_study.h>

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/dense.h>
#include <brdfs/fit/fit_statistics.h>
#include <brdfs/fit/held_by_bounds.h>
#include <brdfs/fit/instrument/instrument_system.h>
#include <brdfs/fit/minimum_study.h>
#include <brdfs/fit/propagated_errors.h>
#include <brdfs/fit/resampling.h>
#include <brdfs/fit/scan_spread.h>
#include <brdfs/fit/unseen_lobes.h>

#include <fmt/format.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace hshfit::brdfs {
namespace {

using Indices = std::vector<Eigen::Index>;

/// Leverages of values and, in all, of priors; the sum of squared gradient terms (HC3).
struct Leverages {
    std::vector<double> values;
    double priors = 0;
    Matrix spread;
};

Leverages leveragesOf(const WholeSystem& system, const Matrix& inverse) {
    Leverages result;
    result.values.resize(system.rows().material.size());
    result.spread = Matrix::Zero(system.size(), system.size());
    system.forEachValue([&](std::size_t v, const Indices& places, const Vector& slopes, double r) {
        const Matrix own = inverse(places, places);
        const double leverage = slopes.dot(own * slopes);
        result.values[v] = leverage;
        const Vector pull = slopes * (r / std::max(1 - leverage, leastFreedom));
        for (std::size_t i = 0; i < places.size(); ++i)
            for (std::size_t j = 0; j < places.size(); ++j)
                result.spread(places[i], places[j]) += pull(at(i)) * pull(at(j));
    });
    for (const WholeSystem::Prior& prior : system.priors()) {
        result.priors += prior.weight * inverse(prior.place, prior.place);
        result.spread(prior.place, prior.place) += prior.weight;
    }
    return result;
}

/// Names and values of x, then of the free scales; where a bound holds them.
struct Described {
    std::vector<FittedParameter> parameters = {};
    std::vector<bool> fixed = {};
    std::vector<double> slope = {};
    double projectedGradient = 0;
};

/// The parameters that scans share: their matrix, and the degrees of freedom of variances by scan.
struct Shared {
    Equations equations;  ///< in units of the cost
    std::vector<bool> fixed;
    std::shared_ptr<const VarianceFreedom> freedom;
};

Shared sharedBy(const InstrumentProblem& problem, const WholeSystem& system,
                const Described& described) {
    const Eigen::Index count = system.commonCount();
    Shared result;
    result.equations = equationsOf(system.reduced() / problem.normalisation(), {});
    result.fixed.assign(described.fixed.begin(), described.fixed.begin() + count);
    const std::vector<double> inverse = inverseOf(result.equations, result.fixed);
    result.freedom = std::make_shared<const VarianceFreedom>(
        system.scanSums(),
        Eigen::Map<const Matrix>(inverse.data(), count, count) / problem.normalisation(),
        Eigen::Map<const Vector>(described.slope.data(), count));
    return result;
}

/// Errors by scan of what scans share, and of the places of scans by what they follow of it and by
/// their own.
Covariance covarianceByScan(const InstrumentProblem& problem, const WholeSystem& system,
                            Shared& shared, double variance) {
    const std::size_t count = problem.commonCount(),
                      total = static_cast<std::size_t>(system.size());
    const double unit = problem.normalisation();
    Matrix spread = shared.freedom->spread();
    for (const WholeSystem::Prior& prior : system.priors())
        if (prior.place < at(count)) spread(prior.place, prior.place) += prior.weight;
    spread /= unit * unit;
    shared.equations.spread.assign(spread.data(), spread.data() + spread.size());
    Covariance result = covarianceOf(shared.equations, shared.fixed);
    const Matrix whole = system.followed(
        Eigen::Map<const Matrix>(result.whole.data(), at(count), at(count)), variance);
    for (std::size_t i = count; i < total; ++i) result.variance.push_back(whole(at(i), at(i)));
    result.correlations.assign(total * total, 0);
    result.whole.assign(whole.data(), whole.data() + whole.size());
    for (std::size_t i = 0; i < total; ++i)
        for (std::size_t j = 0; j < total; ++j)
            if (result.variance[i] > 0 && result.variance[j] > 0)
                result.correlations[i * total + j] =
                    whole(at(i), at(j)) / std::sqrt(result.variance[i] * result.variance[j]);
    return result;
}

FittedParameter parameterOf(std::string name, std::string channel, double value) {
    FittedParameter parameter;
    parameter.name = std::move(name);
    parameter.channel = std::move(channel);
    parameter.value = value;
    return parameter;
}

FittedParameter named(const InstrumentProblem& problem, std::size_t i, double value,
                      const std::vector<std::string>& names) {
    const std::size_t shapes = problem.shapeCount(), channels = problem.channels();
    if (i < shapes)
        return parameterOf(problem.sum().shapes()[i].name, "",
                           problem.sum().shapes()[i].toValue(value));
    FittedParameter parameter;
    const auto ofChannel = [&](const std::string& name, std::size_t c) {
        parameter = parameterOf(name, names.size() > 1 ? names[c] : "", value);
    };
    for (const InstrumentProblem::Zero& zero : problem.zeros()) {
        if (i < zero.first || i >= zero.first + zero.priors.size()) continue;
        const char* name = zero.detector ? "detector zero" : "incidence zero";
        parameter = parameterOf(zero.ofScan ? fmt::format("{} {}", name, i - zero.first + 1) : name,
                                "", value);
        parameter.instrument = true;
        return parameter;
    }
    if (i == problem.strayPlace())
        parameter = parameterOf("stray", "", value);
    else if (problem.darkPlace() && i >= *problem.darkPlace())
        ofChannel("dark", i - *problem.darkPlace());
    else if (problem.offsetPlace() && i >= *problem.offsetPlace())
        ofChannel("offset", i - *problem.offsetPlace());
    else
        ofChannel(problem.sum().linears()[(i - shapes) / channels].name, (i - shapes) % channels);
    parameter.linear = true;
    parameter.instrument = i >= shapes + problem.sum().linears().size() * channels;
    return parameter;
}

Described describedAt(const InstrumentProblem& problem, const std::vector<double>& x,
                      const Equations& reduced, const WholeSystem& system) {
    const HeldByBounds held = heldByBounds(x, reduced, problem.bounds());
    Described result{.fixed = held.fixed, .projectedGradient = held.projectedGradient};
    const std::vector<std::string> names = problem.readings().samples.channels.names();
    for (std::size_t i = 0; i < x.size(); ++i) {
        FittedParameter parameter = named(problem, i, x[i], names);
        parameter.bound = held.bound[i];
        result.slope.push_back(
            i < problem.shapeCount() ? problem.sum().shapes()[i].slope(parameter.value) : 1);
        result.parameters.push_back(std::move(parameter));
    }
    for (const std::size_t s : system.scales()) {
        result.parameters.push_back(
            parameterOf(fmt::format("scale {}", s + 1), "", system.rows().scales[s]));
        result.parameters.back().linear = result.parameters.back().instrument = true;
        result.fixed.push_back(false);
        result.slope.push_back(1);
    }
    return result;
}

/// The places in x of the shapes and of one channel's linear parameters.
std::vector<std::size_t> placesOf(const InstrumentProblem& problem, std::size_t c) {
    std::vector<std::size_t> places;
    for (std::size_t j = 0; j < problem.shapeCount(); ++j) places.push_back(j);
    for (std::size_t k = 0; k < problem.sum().linears().size(); ++k)
        places.push_back(problem.shapeCount() + k * problem.channels() + c);
    return places;
}

void addBootstrapOfReadings(const InstrumentProblem& problem, const std::vector<double>& x,
                            const FitOptions& options, Uncertainty& result) {
    const Readings& readings = problem.readings();
    const auto members = scanMembers(readings.samples);
    const auto refit = [&](std::size_t b) {
        const std::vector<std::size_t> times =
            timesDrawn(members, readings.samples.size(), options.seed, b);
        const InstrumentProblem again(readings, problem.sum(), options.loss,
                                      {times.begin(), times.end()});
        const Bounds bounds = problem.bounds();
        Minimum found = minimise([&](std::span<const double> at,
                                     bool derivatives) { return again.equations(at, derivatives); },
                                 x, bounds.lower, bounds.upper);
        if (!found.converged) return std::vector<double>();
        for (std::size_t j = 0; j < problem.shapeCount(); ++j)
            found.x[j] = problem.sum().shapes()[j].toValue(found.x[j]);
        return std::move(found.x);
    };
    addBootstrap(refit, options.uncertainty, result);
}

/// Picks the values of one channel's sum from the values of all parameters.
std::vector<double> ofChannel(const InstrumentProblem& problem, const std::vector<double>& values,
                              std::size_t c) {
    std::vector<double> own;
    for (const std::size_t i : placesOf(problem, c)) own.push_back(values[i]);
    return own;
}

/// The material as a point about which f is predicted: its parameters are coefficients.
FittedPoint pointOf(const InstrumentProblem& problem, const Covariance& covariance,
                    const Described& described) {
    FittedPoint point;
    point.isotropic = problem.readings().samples.isotropic;
    std::vector<double> values;
    for (const FittedParameter& own : described.parameters) values.push_back(own.value);
    for (std::size_t c = 0; c < problem.channels(); ++c) {
        FittedChannel channel{problem.sum().spec(), ofChannel(problem, values, c), {}};
        for (const std::size_t i : placesOf(problem, c)) channel.slopes.push_back({{i, 1}});
        point.channels.push_back(std::move(channel));
    }
    point.covariance = covarianceOfValues(covariance, described.slope);
    return point;
}

/// Degrees of freedom of errors by the sandwich, of values and priors; null: very many values.
std::shared_ptr<const VarianceFreedom> freedomOfValues(const WholeSystem& system,
                                                       const Matrix& inverse,
                                                       const Described& described) {
    const std::size_t values = system.rows().material.size();
    if (values > mostFreedomValues) return {};
    Matrix rows = Matrix::Zero(at(values + system.priors().size()), system.size());
    system.forEachValue([&](std::size_t v, const Indices& places, const Vector& slopes, double) {
        rows(at(v), places) = slopes;
    });
    for (std::size_t i = 0; i < system.priors().size(); ++i)
        rows(at(values + i), system.priors()[i].place) = std::sqrt(system.priors()[i].weight);
    return std::make_shared<const VarianceFreedom>(
        std::move(rows), inverse, Eigen::Map<const Vector>(described.slope.data(), system.size()));
}

/// The values at the minimum, with squares and leverages of the priors.
StudiedValues valuesOf(const InstrumentProblem& problem, const WholeSystem& system,
                       const std::vector<double>& x, const Leverages& leverages, bool byScan) {
    const FitSamples& samples = problem.readings().samples;
    StudiedValues values{.stated = !samples.sigmas.empty(),
                         .correlated = samples.correlation.any()};
    values.leverages = leverages.values;
    values.residuals.resize(leverages.values.size());
    system.forEachValue(
        [&](std::size_t v, const Indices&, const Vector&, double r) { values.residuals[v] = r; });
    for (std::size_t v = 0; v < values.residuals.size(); ++v)
        values.models.push_back(system.modelAt(v, problem.scanOf(v % samples.size())));
    values.otherRank = leverages.priors;
    values.otherCount = static_cast<double>(system.priors().size());
    values.otherSquares = problem.zeroSquares(x);
    for (const std::size_t s : system.scales())
        values.otherSquares += problem.priorSquare(s, system.rows().scales[s]);
    if (byScan) values.scans = *std::ranges::max_element(samples.scans) + 1;
    for (const auto& places : system.rows().places)
        values.scanParameters = std::max(values.scanParameters, places.size());
    if (byScan) requireScans(values.scans, values.scanParameters, values.stated);
    return values;
}

/// The changes by contributions, with scales as they are, of all parameters.
CommonChanges changesOf(const InstrumentProblem& problem, const WholeSystem& system,
                        const std::vector<double>& x, const Matrix& inverse,
                        const Described& described, const FitOptions& options) {
    const Readings& readings = problem.readings();
    CommonChanges changes;
    for (const Contribution& contribution : options.contributions) {
        const std::vector<double> shift = shiftOf(
            contribution, readings.samples, readings.instrument.darkOver,
            [&](const FitSamples& turned) {
                Readings other = readings;
                other.samples = turned;
                std::vector<double> values =
                    InstrumentProblem(other, problem.sum(), options.loss).rows(x, false).material;
                for (std::size_t v = 0; v < values.size(); ++v)
                    values[v] *= system.rows().scales[problem.scanOf(v % turned.size())];
                return values;
            });
        Vector pull = Vector::Zero(system.size());
        system.forEachValue(
            [&](std::size_t v, const Indices& places, const Vector& slopes, double) {
                pull(places) += std::sqrt(system.rows().weights[v]) * shift[v] * slopes;
            });
        const Vector change =
            (inverse * pull)
                .cwiseProduct(Eigen::Map<const Vector>(described.slope.data(), system.size()));
        changes.parameters.emplace_back(change.begin(), change.end());
    }
    return changes;
}

/// Degrees of freedom of the errors of all parameters: infinite for those that have none here.
std::vector<double> degreesOf(std::vector<double> degrees, std::size_t count) {
    constexpr double known = std::numeric_limits<double>::infinity();
    for (double& own : degrees) own = own > 0 ? std::max(own, 1.0) : known;
    degrees.resize(count, known);
    return degrees;
}

/// Adds bootstrap and profiles, as far as they are asked for.
void addStudies(const InstrumentProblem& problem, const std::vector<double>& x,
                const Equations& equations, const Described& described, const FitOptions& options,
                Uncertainty& study) {
    const std::size_t shapes = problem.shapeCount();
    if (options.uncertainty.bootstrap > 0) addBootstrapOfReadings(problem, x, options, study);
    if (!options.uncertainty.profile) return;
    const auto count = static_cast<std::ptrdiff_t>(x.size());
    const std::vector<double> slope(described.slope.begin(), described.slope.begin() + count);
    const std::vector<bool> fixed(described.fixed.begin(), described.fixed.begin() + count);
    addProfiles({.joint = [&](std::span<const double> other,
                              bool derivatives) { return problem.equations(other, derivatives); },
                 .bounds = problem.bounds(),
                 .normalisation = problem.normalisation(),
                 .valueOf =
                     [&](std::size_t i, double value) {
                         return i < shapes ? problem.sum().shapes()[i].toValue(value) : value;
                     },
                 .x = x,
                 .equations = equations,
                 .fixed = fixed,
                 .slope = slope},
                options.uncertainty, study);
}

}  // namespace

void describeReadings(const InstrumentProblem& problem, const std::vector<double>& x,
                      const FitOptions& options, FitResult& result) {
    const FitSamples& samples = problem.readings().samples;
    const Equations equations = problem.equations(x, true);
    const WholeSystem system(problem, x);
    const Described described = describedAt(problem, x, equations, system);
    const std::vector<bool>& fixed = described.fixed;
    const double unit = problem.normalisation();
    Equations whole = equationsOf(system.hessian() / unit, {});
    const std::vector<double> scaled = inverseOf(whole, fixed);
    const Matrix inverse =
        Eigen::Map<const Matrix>(scaled.data(), system.size(), system.size()) / unit;
    const Leverages leverages = leveragesOf(system, inverse);
    whole = equationsOf(system.hessian() / unit, leverages.spread / (unit * unit));
    const Covariance sandwich = covarianceOf(whole, fixed);
    const bool correlated = samples.correlation.any();
    const bool byScan = options.uncertainty.report && !samples.scans.empty() && !correlated;
    std::shared_ptr<const VarianceFreedom> freedom;
    Uncertainty study = influences(valuesOf(problem, system, x, leverages, byScan));
    Covariance covariance = sandwich;
    if (correlated) {
        covariance = covarianceOf(
            equationsOf(system.hessian() / unit, system.correlatedSpread() / (unit * unit)), fixed);
    } else if (study.scansSuffice()) {
        Shared shared = sharedBy(problem, system, described);
        covariance =
            covarianceByScan(problem, system, shared, study.stated ? 1 : study.reducedChiSquare());
        freedom = shared.freedom;
    } else if (byScan) {
        covariance = covarianceOf(
            equationsOf(system.hessian() / unit, system.hessian() / (unit * unit)), fixed);
    } else {
        freedom = freedomOfValues(system, inverse, described);
    }
    const std::vector<double> degrees =
        freedom ? freedom->degrees(Matrix::Identity(freedom->count(), freedom->count()))
                : std::vector<double>();
    const std::size_t shapes = problem.shapeCount(), channels = problem.channels();
    reportUnseenLobes(
        {shapes, channels, shapes + problem.sum().linears().size() * channels},
        [&](std::span<const double> other) { return problem.equations(other, true); }, x, equations,
        fixed, covariance);
    result.projectedGradient = described.projectedGradient;
    result.parameters = described.parameters;
    stateErrors(covariance, described.slope, result);
    result.point = pointOf(problem, covariance, described);
    if (freedom) result.point.freedom.push_back({0, freedom});
    if (!options.contributions.empty())
        addBudget(options.contributions, changesOf(problem, system, x, inverse, described, options),
                  degreesOf(degrees, fixed.size()), result);
    if (!options.uncertainty.report) return;
    addErrors({inverse.data(), fixed.size() * fixed.size()}, described.slope, covariance, sandwich,
              study.scansSuffice() ? degrees : std::vector<double>(), study);
    addStudies(problem, x, equations, described, options, study);
    for (const std::vector<double>& draw : study.draws) {
        result.point.draws.emplace_back();
        for (std::size_t c = 0; !draw.empty() && c < channels; ++c)
            result.point.draws.back().push_back(ofChannel(problem, draw, c));
    }
    result.uncertainty = std::move(study);
}

}  // namespace hshfit::brdfs
