#include <brdfs/fit/sellmeier.h>

#include <ceres/jet.h>

#include <algorithm>
#include <array>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t mostTerms = 3;
using Dual = ceres::Jet<double, 2 * mostTerms>;

/// B and C of each term.
std::vector<std::array<Dual, 2>> termsOf(double first, double last,
                                         std::span<const double> coefficients) {
    const double low = first * first * 1e-6, high = last * last * 1e-6;
    std::vector<std::array<Dual, 2>> terms;
    Dual atHigh(0.0);
    for (std::size_t i = 0; i + 1 < coefficients.size(); i += 2) {
        const Dual size(coefficients[i], static_cast<int>(i)),
            pole(coefficients[i + 1], static_cast<int>(i + 1));
        const Dual c = pole * pole;
        if (i < 4) {
            const Dual b = size * (low - c) / low;
            terms.push_back({b, c});
            atHigh += b * high / (high - c);
        } else {
            terms.push_back({size * atHigh * (c - high) / high, c});
        }
    }
    return terms;
}

}  // namespace

void sellmeierBox(double first, double last, double most, std::size_t terms,
                  std::vector<double>& lower, std::vector<double>& upper) {
    const double l = first * 1e-3, u = last * 1e-3;
    // Beyond 10 no dielectric is known, and n of all terms together stays below `most`.
    const double largest = std::min(most, 10.0);
    const double share =
        (largest * largest - 1) / static_cast<double>(std::min<std::size_t>(terms, 2));
    for (std::size_t t = 0; t < terms; ++t) {
        const bool infrared = t == 2;
        lower[2 * t] = infrared ? 0 : 1e-9;
        upper[2 * t] = infrared ? 0.9 : share;
        lower[2 * t + 1] = infrared ? 1.1 * u : 0.01 * l;
        upper[2 * t + 1] = infrared ? 50 * u : 0.9 * l;
    }
}

double sellmeierIndex(double nanometres, double first, double last,
                      std::span<const double> coefficients, double* slopes) {
    const double square = nanometres * nanometres * 1e-6;
    Dual sum(1.0);
    for (const auto& [b, c] : termsOf(first, last, coefficients)) sum += b * square / (square - c);
    const Dual n = sqrt(sum);
    std::copy_n(n.v.data(), coefficients.size(), slopes);
    return n.a;
}

void sellmeierTerms(double first, double last, std::span<const double> coefficients,
                    std::vector<double>& values, std::vector<double>& slopes) {
    const std::size_t n = coefficients.size();
    std::size_t i = 0;
    for (const auto& term : termsOf(first, last, coefficients))
        for (const Dual& own : term) {
            values[i] = own.a;
            std::copy_n(own.v.data(), n, slopes.data() + i++ * n);
        }
}

}  // namespace hshfit::brdfs
