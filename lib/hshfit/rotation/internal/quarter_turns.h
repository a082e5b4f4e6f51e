#pragma once

#include <cstddef>
#include <vector>

namespace hshfit::inline rotation {
namespace kernels {

/// The matrix J of band l exchanges y and z, f(x, y, z) -> f(x, z, y): symmetric and its own
/// inverse. With a = |d^l(pi/2)| up to signs, t_m = (-1)^(m/2 rounded down), and D = 1 but
/// sqrt(1/2) for m = 0,
///     J = D T A T D,   A_(m1,m2) = +-2 a_(m1,m2),  m1 >= m2 >= 0,
/// of which a quarter of the entries differ from 0. The rows of 2 a follow from row l downwards:
///     row_(m-1)[k] = slope_m k row_m[k] + carry_m row_(m+1)[k],
/// from small values to large ones for k <= m, which is stable (Trapani & Navaza 2006, where
/// a_(m1,m2) is Delta^l_(m1,m2)).
struct QuarterSteps {
    const double* start;  ///< row l: 2^(1-l) sqrt(binomial(2l, l + k)), k = 0 .. l
    const double* slope;  ///< [m - 1], m = 1 .. l: -2 / g_m, g_m = sqrt((l + m)(l - m + 1))
    const double* carry;  ///< [m - 1]: -g_(m+1) / g_m
};

/// The steps of all bands below `order`, at most 1020: start values leave the normal doubles there.
class QuarterTables {
public:
    explicit QuarterTables(int order);
    QuarterSteps steps(int l) const;

private:
    std::vector<double> start_, slope_, carry_;
};

constexpr std::size_t rowPadding = 8;
/// A length that whole vectors fill.
constexpr std::size_t padded(std::size_t count) {
    return (count + rowPadding - 1) / rowPadding * rowPadding;
}
/// The place at which row m, of m + 1 values, begins.
constexpr std::size_t rowOffset(std::size_t m) {
    const std::size_t q = m / rowPadding, r = m % rowPadding;
    return rowPadding * (q + 1) * (rowPadding / 2 * q + r);
}

/// 2 a_(m1,m2) at rows[rowOffset(m1) + m2], m2 <= m1 <= l; rowOffset(l + 1) doubles.
void quarterRows(int l, const QuarterSteps& steps, double* rows);

/// out = A in for one vector: cosines, m = 0 .. l, at [m], sines at [padded(l + 1) + m]; the sine
/// of m = 0 is 0 in `in` and without meaning in `out`. Beyond l, `in` has to be finite.
void applyQuarter(int l, const double* rows, const double* in, double* out);

}  // namespace kernels
}  // namespace hshfit::inline rotation
