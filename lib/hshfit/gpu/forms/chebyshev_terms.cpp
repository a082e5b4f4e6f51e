#include <hshfit/gpu/forms/internal/chebyshev_terms.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace hshfit::gpu::inline forms {
namespace {

/// [n][m]: sqrt(2 n + 1) P_n = sum over m <= n of this times T_m, by the recurrence
/// (n + 1) P_{n+1} = (2 n + 1) t P_n - n P_{n-1} with 2 t T_m = T_{m+1} + T_{|m-1|}.
std::vector<std::vector<double>> legendreInChebyshev(int count) {
    const auto size = static_cast<std::size_t>(count);
    std::vector<std::vector<double>> rows(size, std::vector<double>(size + 1, 0.0));
    rows[0][0] = 1;
    for (std::size_t n = 0; n + 1 < size; ++n) {
        const auto order = static_cast<double>(n);
        for (std::size_t m = 0; m <= n; ++m) {
            const double half = (2 * order + 1) / (order + 1) * rows[n][m] / 2;
            rows[n + 1][m + 1] += half;
            rows[n + 1][m == 0 ? 1 : m - 1] += half;
        }
        for (std::size_t m = 0; n > 0 && m < n; ++m)
            rows[n + 1][m] -= order / (order + 1) * rows[n - 1][m];
    }
    for (std::size_t n = 0; n < size; ++n)
        for (double& value : rows[n]) value *= std::sqrt(2 * static_cast<double>(n) + 1);
    return rows;
}

}  // namespace

std::vector<double> chebyshevValues(const HalfwayTerms& terms, std::vector<double> values) {
    std::map<HalfwayTerm, std::size_t> places;
    for (std::size_t t = 0; t < terms.size(); ++t) places[terms.list()[t]] = t;
    const HalfwayCounts& counts = terms.counts();
    const std::pair<int HalfwayTerm::*, int> axes[] = {
        {&HalfwayTerm::i, std::max(counts.mean, counts.x)},
        {&HalfwayTerm::j, counts.v},
        {&HalfwayTerm::k, counts.product},
    };
    for (const auto& [degree, count] : axes) {
        const auto rows = legendreInChebyshev(count);
        std::vector<double> sums(values.size(), 0.0);
        for (std::size_t t = 0; t < values.size(); ++t) {
            HalfwayTerm lower = terms.list()[t];
            // Along the third axis the lobe has powers of kappa.
            if (lower.lobe && degree == &HalfwayTerm::k) {
                sums[t] += values[t];
                continue;
            }
            const auto n = static_cast<std::size_t>(lower.*degree);
            for (std::size_t m = n % 2; m <= n; m += 2) {
                lower.*degree = static_cast<int>(m);
                sums[places.at(lower)] += rows[n][m] * values[t];
            }
        }
        values = std::move(sums);
    }
    return values;
}

}  // namespace hshfit::gpu::inline forms
