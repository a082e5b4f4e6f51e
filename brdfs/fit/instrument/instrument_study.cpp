#include <brdfs/fit/instrument/instrument_study.h>

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/minimum_study.h>
#include <brdfs/fit/percentiles.h>
#include <brdfs/fit/resampling.h>
#include <brdfs/fit/scan_spread.h>
#include <brdfs/fit/unseen_lobes.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hshfit::brdfs {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Indices = std::vector<Eigen::Index>;

Eigen::Index at(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

Equations equationsOf(const Matrix& hessian, const Matrix& spread) {
    Equations result;
    result.hessian.assign(hessian.data(), hessian.data() + hessian.size());
    result.spread.assign(spread.data(), spread.data() + spread.size());
    return result;
}

/// The normal equations of x and of the scales that are free, in units of the weights.
class WholeSystem {
public:
    WholeSystem(const InstrumentProblem& problem, const std::vector<double>& x)
        : problem_(problem),
          samples_(problem.readings().samples),
          rows_(problem.rows(x, true)),
          count_(x.size()) {
        for (std::size_t s = 0; s < problem.scanCount(); ++s) {
            scalePlaces_.push_back(problem.freeScale(s) ? at(count_ + scales_.size()) : -1);
            if (problem.freeScale(s)) scales_.push_back(s);
        }
        hessian_ = Matrix::Zero(size(), size());
        forEachValue([&](std::size_t, const Indices& places, const Vector& slopes, double) {
            for (Eigen::Index i = 0; i < slopes.size(); ++i)
                for (Eigen::Index j = 0; j < slopes.size(); ++j)
                    hessian_(places[static_cast<std::size_t>(i)],
                             places[static_cast<std::size_t>(j)]) += slopes(i) * slopes(j);
        });
        for (const std::size_t s : scales_) {
            const Eigen::Index place = scalePlaces_[s];
            hessian_(place, place) += problem.priorWeight(s, rows_.scales[s]);
        }
    }

    Eigen::Index size() const { return at(count_ + scales_.size()); }
    const Matrix& hessian() const { return hessian_; }
    const std::vector<std::size_t>& scales() const { return scales_; }
    const ReadingRows& rows() const { return rows_; }

    /// work(value, places, slopes, residual), the last two times the root of the weight; residual =
    /// measured - model.
    template <class Work>
    void forEachValue(const Work& work) const {
        for (std::size_t c = 0; c < problem_.channels(); ++c) {
            const std::vector<std::size_t>& own = rows_.places[c];
            Indices places(own.begin(), own.end());
            Vector slopes(at(own.size()));
            for (std::size_t k = 0; k < samples_.size(); ++k) {
                const std::size_t v = c * samples_.size() + k, scan = problem_.scanOf(k);
                const double root = std::sqrt(rows_.weights[v]);
                places.resize(own.size());
                slopes.resize(at(own.size()));
                for (std::size_t i = 0; i < own.size(); ++i)
                    slopes(at(i)) = root * rows_.slopes[c][k * own.size() + i];
                if (scalePlaces_[scan] >= 0) {
                    places.push_back(scalePlaces_[scan]);
                    slopes.conservativeResize(at(own.size()) + 1);
                    slopes(at(own.size())) = root * rows_.material[v];
                }
                work(v, places, slopes, root * (samples_.values[v] - modelAt(v, scan)));
            }
        }
    }
    double modelAt(std::size_t v, std::size_t scan) const {
        return rows_.scales[scan] * rows_.material[v] + rows_.added[v];
    }

    /// Of each scan of the samples, with its scale eliminated.
    std::vector<ScanSums> scanSums() const {
        const std::vector<std::size_t>& scans = samples_.scans;
        const std::size_t all = *std::ranges::max_element(scans) + 1;
        std::vector<ScanSums> sums(
            all, {Matrix::Zero(at(count_), at(count_)), Vector::Zero(at(count_))});
        forEachValue([&](std::size_t v, const Indices& places, const Vector& slopes, double r) {
            ScanSums& scan = sums[scans[v % samples_.size()]];
            for (std::size_t i = 0; i < places.size() && places[i] < at(count_); ++i) {
                scan.gradient(places[i]) += slopes(at(i)) * r;
                for (std::size_t j = 0; j < places.size() && places[j] < at(count_); ++j)
                    scan.matrix(places[i], places[j]) += slopes(at(i)) * slopes(at(j));
            }
        });
        for (const std::size_t s : scales_) {
            const Vector across = acrossOf(s);
            sums[s].matrix -= across * across.transpose() / ownOf(s);
        }
        return sums;
    }
    /// The part of the matrix of a scale with x, and its own.
    Vector acrossOf(std::size_t scan) const {
        return hessian_.col(scalePlaces_[scan]).head(at(count_));
    }
    double ownOf(std::size_t scan) const {
        return hessian_(scalePlaces_[scan], scalePlaces_[scan]);
    }

private:
    const InstrumentProblem& problem_;
    const FitSamples& samples_;
    ReadingRows rows_;
    std::size_t count_;
    std::vector<std::size_t> scales_;  ///< scans whose scale is free
    Indices scalePlaces_;              ///< of each scan; -1: none
    Matrix hessian_;
};

/// Leverages of values and, in all, of priors; the sum of squared gradient terms (HC3).
struct Leverages {
    std::vector<double> values;
    double priors = 0;
    Matrix spread;
};

Leverages leveragesOf(const InstrumentProblem& problem, const WholeSystem& system,
                      const Matrix& inverse) {
    constexpr double leastFreedom = 1e-6;
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
    const Eigen::Index first = system.size() - at(system.scales().size());
    for (std::size_t i = 0; i < system.scales().size(); ++i) {
        const Eigen::Index place = first + at(i);
        const std::size_t scan = system.scales()[i];
        const double prior = problem.priorWeight(scan, system.rows().scales[scan]);
        result.priors += prior * inverse(place, place);
        result.spread(place, place) += prior;
    }
    return result;
}

/// Errors by scan of x, and of the scales by what they follow of x and by their own.
Covariance covarianceByScan(const InstrumentProblem& problem, const WholeSystem& system,
                            const Equations& reduced, const std::vector<bool>& fixed,
                            double variance) {
    const std::size_t count = problem.count(), total = static_cast<std::size_t>(system.size());
    const double scale = problem.normalisation();
    const std::vector<double> inverse = inverseOf(reduced, fixed);
    const Matrix own = Eigen::Map<const Matrix>(inverse.data(), at(count), at(count)) / scale;
    Equations equations = reduced;
    const Matrix spread = scanSpread(system.scanSums(), own) / (scale * scale);
    equations.spread.assign(spread.data(), spread.data() + spread.size());
    const Covariance ofX = covarianceOf(equations, fixed);
    if (system.scales().empty()) return ofX;
    Matrix among = Matrix::Zero(at(count), at(count));
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j)
            if (ofX.variance[i] >= 0 && ofX.variance[j] >= 0)
                among(at(i), at(j)) = (i == j ? 1 : ofX.correlations[i * count + j]) *
                                      std::sqrt(ofX.variance[i] * ofX.variance[j]);
    // Derivatives of scales by x.
    Matrix follow(at(system.scales().size()), at(count));
    for (std::size_t i = 0; i < system.scales().size(); ++i) {
        const std::size_t scan = system.scales()[i];
        follow.row(at(i)) = -system.acrossOf(scan).transpose() / system.ownOf(scan);
    }
    Matrix whole(system.size(), system.size());
    const Matrix mixed = follow * among;
    whole.topLeftCorner(at(count), at(count)) = among;
    whole.bottomLeftCorner(follow.rows(), at(count)) = mixed;
    whole.topRightCorner(at(count), follow.rows()) = mixed.transpose();
    whole.bottomRightCorner(follow.rows(), follow.rows()) = mixed * follow.transpose();
    for (std::size_t i = 0; i < system.scales().size(); ++i)
        whole(at(count + i), at(count + i)) += variance / system.ownOf(system.scales()[i]);
    Covariance result;
    result.ambiguous = ofX.ambiguous;
    result.correlations.assign(total * total, 0);
    for (std::size_t i = 0; i < total; ++i) {
        const bool none = i < count && ofX.variance[i] < 0;
        result.variance.push_back(none ? -1 : whole(at(i), at(i)));
    }
    for (std::size_t i = 0; i < total; ++i)
        for (std::size_t j = 0; j < total; ++j) {
            const double size = result.variance[i] * result.variance[j];
            if (result.variance[i] > 0 && result.variance[j] > 0)
                result.correlations[i * total + j] = whole(at(i), at(j)) / std::sqrt(size);
        }
    return result;
}

/// Of the errors of x by scan.
std::vector<double> degreesByScan(const InstrumentProblem& problem, const WholeSystem& system,
                                  const Equations& reduced, const std::vector<bool>& fixed) {
    const Eigen::Index count = at(problem.count());
    const std::vector<double> inverse = inverseOf(reduced, fixed);
    return scanDegrees(
        system.scanSums(),
        Eigen::Map<const Matrix>(inverse.data(), count, count) / problem.normalisation(),
        Matrix::Identity(count, count));
}

/// Names and values of x, then of the free scales; where a bound holds them.
struct Described {
    std::vector<FittedParameter> parameters;
    std::vector<bool> fixed;
    std::vector<double> slope;
    double projectedGradient = 0;
};

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
    Described result;
    const Bounds bounds = problem.bounds();
    const std::vector<std::string> names = problem.readings().samples.channels.names();
    for (std::size_t i = 0; i < x.size(); ++i) {
        FittedParameter parameter = named(problem, i, x[i], names);
        const double reach = 1e-9 * (1 + std::abs(x[i])), pull = reduced.gradient[i];
        if (x[i] <= bounds.lower[i] + reach && pull >= 0) parameter.bound = "lower";
        if (x[i] >= bounds.upper[i] - reach && pull <= 0) parameter.bound = "upper";
        // As in fits without an instrument: held only by a pull worth the name.
        const double scale = std::sqrt(std::max(reduced.hessian[i * x.size() + i], 0.0));
        const double negligible = 1e-6 * std::sqrt(2 * reduced.cost) + 1e-12;
        result.fixed.push_back(!parameter.bound.empty() && std::abs(pull) > negligible * scale);
        if (!result.fixed[i] && scale > 0)
            result.projectedGradient = std::max(result.projectedGradient, std::abs(pull) / scale);
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

void addBootstrapOfReadings(const InstrumentProblem& problem, const std::vector<double>& x,
                            const FitOptions& options, Uncertainty& result) {
    const Readings& readings = problem.readings();
    const std::size_t count = readings.samples.size();
    const auto members = scanMembers(readings.samples);
    std::vector<std::vector<double>> draws(options.uncertainty.bootstrap);
    std::atomic<std::size_t> done = 0;
    const Bounds bounds = problem.bounds();
    tbb::parallel_for(std::size_t{0}, draws.size(), [&](std::size_t b) {
        const std::vector<std::size_t> times = timesDrawn(members, count, options.seed, b);
        const InstrumentProblem again(readings, problem.sum(), options.loss,
                                      {times.begin(), times.end()});
        const Minimum found =
            minimise([&](std::span<const double> at,
                         bool derivatives) { return again.equations(at, derivatives); },
                     x, bounds.lower, bounds.upper);
        if (found.converged) draws[b] = found.x;
        if (options.uncertainty.progress) options.uncertainty.progress(++done, draws.size());
    });
    result.bootstrapDraws = draws.size();
    result.bootstrapFailures =
        static_cast<std::size_t>(std::ranges::count_if(draws, &std::vector<double>::empty));
    if (draws.size() - result.bootstrapFailures < 2)
        throw NumericError(
            fmt::format("{} of {} fits to resampled data converged; expected at least 2",
                        draws.size() - result.bootstrapFailures, draws.size()));
    for (std::size_t i = 0; i < x.size(); ++i) {
        std::vector<double> values;
        for (const std::vector<double>& draw : draws)
            if (!draw.empty())
                values.push_back(i < problem.shapeCount()
                                     ? problem.sum().shapes()[i].toValue(draw[i])
                                     : draw[i]);
        result.parameters[i].bootstrap = summarised(std::move(values));
    }
}

std::vector<std::vector<std::string>> namesOf(const std::vector<std::vector<std::size_t>>& sets,
                                              const std::vector<FittedParameter>& parameters) {
    std::vector<std::vector<std::string>> result;
    for (const auto& set : sets) {
        result.emplace_back();
        for (const std::size_t i : set)
            result.back().push_back(parameters[i].channel.empty()
                                        ? parameters[i].name
                                        : parameters[i].name + " " + parameters[i].channel);
    }
    return result;
}

}  // namespace

void describeReadings(const InstrumentProblem& problem, const std::vector<double>& x,
                      const FitOptions& options, FitResult& result) {
    const FitSamples& samples = problem.readings().samples;
    const Equations reduced = problem.equations(x, true);
    const WholeSystem system(problem, x);
    Described described = describedAt(problem, x, reduced, system);
    const std::vector<bool>& fixed = described.fixed;
    const double unit = problem.normalisation();
    Equations whole = equationsOf(system.hessian() / unit, {});
    const std::vector<double> scaled = inverseOf(whole, fixed);
    const Matrix inverse =
        Eigen::Map<const Matrix>(scaled.data(), system.size(), system.size()) / unit;
    const Leverages leverages = leveragesOf(problem, system, inverse);
    whole = equationsOf(system.hessian() / unit, leverages.spread / (unit * unit));
    const Covariance sandwich = covarianceOf(whole, fixed);

    StudiedValues values{.stated = !samples.sigmas.empty()};
    values.leverages = leverages.values;
    values.residuals.resize(leverages.values.size());
    system.forEachValue(
        [&](std::size_t v, const Indices&, const Vector&, double r) { values.residuals[v] = r; });
    for (std::size_t v = 0; v < values.residuals.size(); ++v)
        values.models.push_back(system.modelAt(v, problem.scanOf(v % samples.size())));
    values.otherRank = leverages.priors;
    for (const std::size_t s : system.scales()) {
        values.otherSquares += problem.priorSquare(s, system.rows().scales[s]);
        values.otherCount += problem.priorOf(s) > 0 ? 1 : 0;
    }
    const bool byScan = options.uncertainty.report && !samples.scans.empty();
    if (byScan) values.scans = *std::ranges::max_element(samples.scans) + 1;
    for (const auto& places : system.rows().places)
        values.scanParameters = std::max(values.scanParameters, places.size());
    if (byScan) requireScans(values.scans, values.scanParameters, values.stated);
    Uncertainty study = influences(values);
    const std::vector<bool> fixedX(fixed.begin(),
                                   fixed.begin() + static_cast<std::ptrdiff_t>(x.size()));
    Covariance covariance = sandwich;
    if (study.scansSuffice())
        covariance = covarianceByScan(problem, system, reduced, fixedX,
                                      study.stated ? 1 : study.reducedChiSquare());
    else if (byScan)
        covariance = covarianceOf(
            equationsOf(system.hessian() / unit, system.hessian() / (unit * unit)), fixed);
    const std::size_t shapes = problem.shapeCount(), channels = problem.channels();
    reportUnseenLobes(
        {shapes, channels, shapes + problem.sum().linears().size() * channels},
        [&](std::span<const double> other) { return problem.equations(other, true); }, x, reduced,
        fixed, covariance);
    for (std::size_t i = 0; i < fixed.size(); ++i)
        if (covariance.variance[i] >= 0)
            described.parameters[i].standardError =
                std::sqrt(covariance.variance[i]) * described.slope[i];
    result.ambiguous = namesOf(covariance.ambiguous, described.parameters);
    result.correlations = covariance.correlations;
    result.projectedGradient = described.projectedGradient;
    if (options.uncertainty.report) {
        addErrors({inverse.data(), fixed.size() * fixed.size()}, described.slope, covariance,
                  sandwich,
                  study.scansSuffice() ? degreesByScan(problem, system, reduced, fixedX)
                                       : std::vector<double>(),
                  study);
        if (options.uncertainty.bootstrap > 0) addBootstrapOfReadings(problem, x, options, study);
        if (options.uncertainty.profile) {
            const std::vector<double> slopeX(
                described.slope.begin(),
                described.slope.begin() + static_cast<std::ptrdiff_t>(x.size()));
            addProfiles(
                {.joint = [&](std::span<const double> other,
                              bool derivatives) { return problem.equations(other, derivatives); },
                 .bounds = problem.bounds(),
                 .normalisation = unit,
                 .valueOf =
                     [&](std::size_t i, double value) {
                         return i < shapes ? problem.sum().shapes()[i].toValue(value) : value;
                     },
                 .x = x,
                 .equations = reduced,
                 .fixed = fixedX,
                 .slope = slopeX},
                options.uncertainty, study);
        }
        result.uncertainty = std::move(study);
    }
    result.parameters = std::move(described.parameters);
}

}  // namespace hshfit::brdfs
