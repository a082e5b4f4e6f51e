#include <brdfs/fit/distributions.h>
#include <brdfs/fit/stated_error.h>

#include <algorithm>
#include <limits>

namespace hshfit::brdfs {

double coverageFactor(double degrees) {
    return studentBound(1 - Budget::probability, degrees);
}

const ParameterBudget* budgetOf(const FitResult& result, const FittedParameter& parameter) {
    if (!result.budget) return nullptr;
    for (const ParameterBudget& own : result.budget->parameters)
        if (own.name == parameter.name && own.channel == parameter.channel) return &own;
    return nullptr;
}

std::optional<StatedError> statedError(const FitResult& result, std::size_t parameter) {
    const FittedParameter& own = result.parameters[parameter];
    if (!own.standardError) return std::nullopt;
    StatedError stated{.error = *own.standardError, .route = "sandwich"};
    const std::size_t count = result.parameters.size();
    stated.degrees = static_cast<double>(result.values > count ? result.values - count : 1);
    if (const auto& study = result.uncertainty) {
        stated.degrees = static_cast<double>(std::max<std::size_t>(study->degreesOfFreedom, 1));
        const ParameterUncertainty& errors = study->parameters[parameter];
        if (errors.correlated) {
            stated.route = "correlated";
            stated.degrees = std::numeric_limits<double>::infinity();
        } else if (study->scans > 0 && !study->scansSuffice()) {
            stated.route = "normal";
            stated.degrees = std::numeric_limits<double>::infinity();
        } else if (errors.scans && errors.scanDegrees) {
            stated.route = "by scan";
            stated.degrees = *errors.scanDegrees;
        }
    }
    if (const ParameterBudget* budget = budgetOf(result, own)) {
        stated.error = budget->combined;
        stated.degrees = budget->degrees;
        stated.factor = budget->coverage;
    } else {
        stated.factor = coverageFactor(stated.degrees);
    }
    return stated;
}

}  // namespace hshfit::brdfs
