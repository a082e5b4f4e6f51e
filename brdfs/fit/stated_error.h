#pragma once

#include <brdfs/fit/fit_result.h>

#include <cstddef>
#include <optional>
#include <string_view>

namespace hshfit::brdfs {

/// The standard uncertainty that a fit states of a parameter, with the factor of its interval.
struct StatedError {
    double error = 0;
    /// "by scan", "correlated", "normal" or "sandwich"; with a budget the route of its first row.
    std::string_view route;
    /// Degrees of freedom of its variance: effective ones of the budget; those by scan; infinite
    /// for stated uncertainties; else values less parameters.
    double degrees = 0;
    double factor = 0;  ///< Student's, of Budget::probability

    double expanded() const { return factor * error; }
};

/// None of a parameter at a bound, or that the data do not determine.
std::optional<StatedError> statedError(const FitResult& result, std::size_t parameter);

/// The factor of a standard uncertainty with these degrees of freedom.
double coverageFactor(double degrees);

/// The part of a budget that is about a parameter; null: none.
const ParameterBudget* budgetOf(const FitResult& result, const FittedParameter& parameter);

}  // namespace hshfit::brdfs
