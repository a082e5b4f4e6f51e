#include <brdfs/fit/fit_statistics.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

void addStatistics(double squares, double weights, bool stated, FitResult& result) {
    result.loss = std::sqrt(squares / weights);
    // The variance of the residuals is a parameter, too, unless it is stated.
    const double count = static_cast<double>(result.values),
                 parameters = static_cast<double>(result.parameters.size() + (stated ? 0 : 1));
    const double likelihood =
        stated ? squares : count * std::log(std::max(squares / weights, 1e-300));
    result.aic = likelihood + 2 * parameters;
    result.bic = likelihood + parameters * std::log(count);
}

void requireValues(const std::string& model, std::size_t values, std::size_t parameters) {
    if (values < parameters)
        throw NumericError(
            fmt::format("'{}': {} values cannot determine {} free parameters; give some of them, "
                        "or more samples",
                        model, values, parameters));
}

void stateErrors(const Covariance& covariance, const std::vector<double>& slope,
                 FitResult& result) {
    for (std::size_t i = 0; i < slope.size(); ++i)
        if (covariance.variance[i] >= 0)
            result.parameters[i].standardError = std::sqrt(covariance.variance[i]) * slope[i];
    result.correlations = covariance.correlations;
    result.ambiguous = labelsOf(covariance.ambiguous, result.parameters);
}

std::vector<std::vector<std::string>> labelsOf(const std::vector<std::vector<std::size_t>>& sets,
                                               const std::vector<FittedParameter>& parameters) {
    std::vector<std::vector<std::string>> labels;
    for (const auto& set : sets) {
        labels.emplace_back();
        for (const std::size_t i : set) labels.back().push_back(parameters[i].label());
    }
    return labels;
}

std::vector<double> covarianceOfValues(const Covariance& covariance,
                                       const std::vector<double>& slope) {
    const std::size_t n = slope.size();
    std::vector<double> whole = covariance.whole;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) whole[i * n + j] *= slope[i] * slope[j];
    return whole;
}

}  // namespace hshfit::brdfs
