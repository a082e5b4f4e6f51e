#include <hshfit/stability/error_trials.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace hshfit::stability {
namespace {

/// Relative errors below this come from basis functions and from models' values.
constexpr double rounding = 1e-12;

Projection projectTrial(const ErrorTrial& trial, double tolerance, std::size_t maxEvaluations) {
    const auto basis = bases::make(trial.basis, trial.order);
    return project(
        *trial.brdf, *basis,
        OutgoingSet::direction(radians(trial.thetaDegrees), radians(trial.phiDegrees)),
        {.quantity = trial.quantity, .tolerance = tolerance, .maxEvaluations = maxEvaluations});
}

double relativeDistance(const std::vector<double>& a, const std::vector<double>& exact) {
    double difference = 0, norm = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        difference += (a[i] - exact[i]) * (a[i] - exact[i]);
        norm += exact[i] * exact[i];
    }
    if (difference == 0) return 0;
    return std::sqrt(difference / norm);
}

ErrorTrialResult tryError(const ErrorTrial& trial, const ErrorTrialOptions& options) {
    const double usual = trial.brdf->defaultTolerance();
    ErrorTrialResult result{.trial = trial,
                            .tolerance = options.tolerance > 0 ? options.tolerance : usual};
    const double least = std::min(result.tolerance, usual);
    Projection found, exact;
    try {
        found = projectTrial(trial, result.tolerance, ProjectionOptions{}.maxEvaluations);
    } catch (const NumericError&) {
        result.state = ErrorTrialResult::State::refused;
        return result;
    }
    result.state = ErrorTrialResult::State::noReference;
    for (const double share : {1e-2, 1e-1}) {
        try {
            exact = projectTrial(trial, share * least, options.referenceEvaluations);
            result.referenceTolerance = share * least;
            result.state = ErrorTrialResult::State::measured;
            break;
        } catch (const NumericError&) {
        }
    }
    // The same nodes would show no error.
    constexpr double finer = 1e-2, finest = 1e-11;
    for (double tolerance = result.referenceTolerance * finer;
         result.state == ErrorTrialResult::State::measured && tolerance > finest * usual &&
         exact.evaluations == found.evaluations;
         tolerance *= finer) {
        try {
            exact = projectTrial(trial, tolerance, options.referenceEvaluations);
            result.referenceTolerance = tolerance;
        } catch (const NumericError&) {
            break;
        }
    }
    const Coefficients& c = found.coefficients;
    result.stated = c.error;
    result.evaluations = found.evaluations;
    if (result.state != ErrorTrialResult::State::measured) return result;
    result.referenceEvaluations = exact.evaluations;
    result.coefficients = relativeDistance(c.values, exact.coefficients.values);
    const Energy& energy = exact.coefficients.energy;
    result.hasEnergy = energy.finite && energy.value > 0 && std::isfinite(energy.value);
    if (result.hasEnergy) {
        result.statedEnergy = c.energy.error / energy.value;
        result.energy = std::abs(c.energy.value - energy.value) / energy.value;
    }
    return result;
}

double median(std::vector<double> values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

ErrorTrialSummary summaryOf(std::string group, const std::vector<const ErrorTrialResult*>& some) {
    ErrorTrialSummary s{.group = std::move(group), .trials = some.size()};
    std::vector<double> overstatements, evaluations;
    for (const ErrorTrialResult* r : some) {
        if (r->state != ErrorTrialResult::State::measured) continue;
        ++s.measured;
        s.coefficientsHold += r->coefficientsHold();
        s.energyMeasured += r->hasEnergy;
        s.energyHolds += r->hasEnergy && r->energyHolds();
        s.bothHold += r->bothHold();
        if (!r->bothHold()) s.exceptions.push_back(*r);
        if (r->coefficients > rounding) s.worst = std::max(s.worst, r->coefficients / r->stated);
        if (r->hasEnergy && r->energy > rounding)
            s.worst = std::max(s.worst, r->energy / r->statedEnergy);
        if (std::isfinite(r->overstatement())) overstatements.push_back(r->overstatement());
        evaluations.push_back(static_cast<double>(r->evaluations));
        s.evaluations += r->evaluations;
    }
    s.medianOverstatement = median(std::move(overstatements));
    s.medianEvaluations = median(std::move(evaluations));
    return s;
}

}  // namespace

bool ErrorTrialResult::coefficientsHold() const {
    return coefficients <= std::max(stated, rounding);
}

bool ErrorTrialResult::energyHolds() const {
    return energy <= std::max(statedEnergy, rounding);
}

double ErrorTrialResult::overstatement() const {
    double least = std::numeric_limits<double>::infinity();
    if (coefficients > rounding) least = stated / coefficients;
    if (hasEnergy && energy > rounding) least = std::min(least, statedEnergy / energy);
    return least;
}

std::vector<ErrorTrialResult> tryErrors(std::span<const ErrorTrial> trials,
                                        const ErrorTrialOptions& options) {
    std::vector<ErrorTrialResult> results(trials.size());
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, trials.size(), [&](std::size_t k) {
        results[k] = tryError(trials[k], options);
        ++done;
        if (options.progress) options.progress(done, trials.size());
    });
    return results;
}

std::vector<ErrorTrialSummary> summarise(std::span<const ErrorTrialResult> results) {
    std::vector<std::string> groups;
    for (const ErrorTrialResult& r : results)
        if (std::ranges::find(groups, r.trial.group) == groups.end())
            groups.push_back(r.trial.group);
    std::vector<ErrorTrialSummary> summaries;
    std::vector<const ErrorTrialResult*> all;
    for (const ErrorTrialResult& r : results) all.push_back(&r);
    for (const std::string& group : groups) {
        std::vector<const ErrorTrialResult*> some;
        for (const ErrorTrialResult& r : results)
            if (r.trial.group == group) some.push_back(&r);
        summaries.push_back(summaryOf(group, some));
    }
    summaries.push_back(summaryOf("all", all));
    return summaries;
}

}  // namespace hshfit::stability
