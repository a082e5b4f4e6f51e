#include <brdfs/fit/fit_statistics.h>

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

}  // namespace hshfit::brdfs
