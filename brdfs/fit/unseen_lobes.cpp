#include <brdfs/fit/unseen_lobes.h>

#include <cmath>
#include <utility>

namespace hshfit::brdfs {

void reportUnseenLobes(const ParameterOrder& order,
                       const std::function<Equations(std::span<const double>)>& joint,
                       const std::vector<double>& x, const Equations& equations,
                       const std::vector<bool>& fixed, Covariance& covariance) {
    const std::size_t n = x.size(), all = fixed.size();
    for (std::size_t first = order.shapes; first < order.end; first += order.channels) {
        std::vector<std::size_t> concerned;
        std::vector<double> without = x;
        bool seen = false;
        for (std::size_t i = first; i < first + order.channels; ++i) {
            without[i] = 0;
            if (fixed[i]) {
                seen = seen || x[i] > 0;
                continue;
            }
            seen =
                seen || covariance.variance[i] < 0 || x[i] > 2 * std::sqrt(covariance.variance[i]);
            concerned.push_back(i);
        }
        if (seen || order.shapes == 0) continue;
        const Equations rest = joint(without);
        const std::size_t linears = concerned.size();
        for (std::size_t j = 0; j < order.shapes; ++j)
            if (!fixed[j] && covariance.variance[j] >= 0 &&
                rest.hessian[j * n + j] <= 1e-12 * equations.hessian[j * n + j])
                concerned.push_back(j);
        if (concerned.size() == linears) continue;
        for (const std::size_t i : concerned) {
            covariance.variance[i] = -1;
            for (std::size_t j = 0; j < all; ++j)
                covariance.correlations[i * all + j] = covariance.correlations[j * all + i] = 0;
        }
        covariance.ambiguous.push_back(std::move(concerned));
    }
}

}  // namespace hshfit::brdfs
