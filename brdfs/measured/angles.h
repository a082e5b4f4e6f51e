#pragma once

// Angles from sines and cosines for the inner loops of the tables: no calls and no branches, so
// that the compiler can vectorise the loops that use them.

#include <hshfit/brdf/directions.h>

#include <array>
#include <cmath>

namespace hshfit::brdfs {

/// atan(t) for 0 <= t <= 1, absolute error below 1e-12, relative error below 4e-11, from
///     atan t = 2 sum_k (-1)^k (sqrt2 - 1)^(2k+1) / (2k+1) T_{2k+1}(t)
/// (T: Chebyshev polynomials), cut after `atanTerms` terms: the remainder is below
/// 2 (sqrt2 - 1)^(2n+1) / (2n+1) (1 + 0.17 + ...), n = atanTerms.
inline constexpr int atanTerms = 14;

/// The series as powers of t^2: atan t = t sum_j c_j t^(2j).
constexpr std::array<double, atanTerms> atanPowers() {
    constexpr int degree = 2 * atanTerms;
    std::array<long double, degree + 1> previous{}, current{}, sum{};
    previous[0] = 1;                                                   // T_0
    current[1] = 1;                                                    // T_1
    const long double ratio = 0.41421356237309504880168872420969808L;  // sqrt2 - 1
    long double power = ratio;
    for (int n = 1; n < degree; n += 2) {
        const long double factor = (n % 4 == 1 ? 2 : -2) * power / n;
        for (int i = 0; i <= degree; ++i) sum[i] += factor * current[i];
        power *= ratio * ratio;
        for (int step = 0; step < 2; ++step) {  // T_{n+1} = 2 t T_n - T_{n-1}
            std::array<long double, degree + 1> next{};
            for (int i = 0; i <= degree; ++i) {
                next[i] = (i > 0 ? 2 * current[i - 1] : 0) - previous[i];
            }
            previous = current;
            current = next;
        }
    }
    std::array<double, atanTerms> powers{};
    for (int j = 0; j < atanTerms; ++j) powers[j] = static_cast<double>(sum[2 * j + 1]);
    return powers;
}

inline double atanUnit(double t) {
    constexpr std::array<double, atanTerms> c = atanPowers();
    // Estrin's scheme in groups of four keeps multiplications independent of each other.
    static_assert(atanTerms == 14);
    const double s = t * t, s2 = s * s, s4 = s2 * s2;
    const double g0 = (c[0] + c[1] * s) + (c[2] + c[3] * s) * s2;
    const double g1 = (c[4] + c[5] * s) + (c[6] + c[7] * s) * s2;
    const double g2 = (c[8] + c[9] * s) + (c[10] + c[11] * s) * s2;
    const double g3 = c[12] + c[13] * s;
    const double value = (g0 + g1 * s4) + (g2 + g3 * s4) * (s4 * s4);
    return value * t;
}

/// atan2(y, x) for x, y >= 0; 0 at the origin.
inline double quadrantAngle(double y, double x) {
    const double large = y > x ? y : x;
    const double small = y > x ? x : y;
    const double angle = atanUnit(small / (large > 1e-300 ? large : 1e-300));
    return y > x ? pi / 2 - angle : angle;
}

/// atan2(y, x) folded to [0, pi]: a line through the origin, not a ray (period pi).
inline double lineAngle(double y, double x) {
    const double angle = quadrantAngle(std::fabs(y), std::fabs(x));
    return (x < 0) != (y < 0) ? pi - angle : angle;
}

/// atan2(y, x) in [-pi, pi]; 0 at the origin.
inline double rayAngle(double y, double x) {
    const double angle = quadrantAngle(std::fabs(y), std::fabs(x));
    const double half = x < 0 ? pi - angle : angle;
    return y < 0 ? -half : half;
}

}  // namespace hshfit::brdfs
