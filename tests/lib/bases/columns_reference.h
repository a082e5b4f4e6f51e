#pragma once

#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <boost/multiprecision/mpfr.hpp>

// Whole columns of the Jacobi family to any degree: the textbook recurrence of unnormalised Jacobi
// polynomials in n (DLMF 18.9.1) in 100 digits, whose exponents cannot overflow. It shares neither
// the normalised recurrence nor the scaling of the library; `bases_reference.h` has the explicit
// sums, which would take thousands of digits at the largest degree.
namespace columns {

using Real = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>,
                                           boost::multiprecision::et_off>;

struct Place {
    Real theta, phi;
};

inline Place place(double x, double y, double z) {
    const Real rx = x, ry = y;
    return {atan2(sqrt(rx * rx + ry * ry), Real(z)), atan2(ry, rx)};
}

/// P_n^{(a,b)}(t) for n = 0 .. last.
inline std::vector<Real> jacobi(int last, int a, int b, const Real& t) {
    std::vector<Real> p{1, (a + 1) + Real(a + b + 2) * (t - 1) / 2};
    for (int n = 1; n < last; ++n) {
        const Real c = 2 * n + a + b;
        const Real up = 2 * Real(n + 1) * (n + a + b + 1) * c;
        const Real level = (c + 1) * (c * (c + 2) * t + Real(a - b) * (a + b));
        const Real down = 2 * Real(n + a) * (n + b) * (c + 2);
        p.push_back(
            (level * p[static_cast<std::size_t>(n)] - down * p[static_cast<std::size_t>(n - 1)]) /
            up);
    }
    p.resize(static_cast<std::size_t>(last + 1));
    return p;
}

/// T_l^m az_m for l = m .. degree, m >= 0. With h the norm of P_n^{(a,b)} over [-1, 1] (DLMF
/// 18.3.1): h_n = 2^{a+b+1}/(2n+a+b+1) (n+a)! (n+b)! / (n! (n+a+b)!).
inline std::vector<Real> values(std::string_view name, int degree, int m, const Place& at) {
    const Real mu = cos(at.theta), half = sin(at.theta / 2), rest = 2 * half * half;
    const bool sphere = name == "sh" || name == "esh", chord = name == "zernike";
    const bool flux = name == "makhotkin" || name == "makhotkin-flux";
    if (!sphere && !chord && !flux && name != "hsh")
        throw std::invalid_argument("no reference for this basis");
    const int a = chord ? 0 : m, b = flux ? m + 1 : m, step = chord ? 2 : 1;
    const Real t = sphere ? mu : chord ? 1 - 2 * mu : 2 * mu - 1;
    // Integral over mu of T^2 is 1: dt = dmu or 2 dmu, with F^{2m} (and mu) as powers of 1 -+ t.
    const Real factor = sphere  ? pow(sin(at.theta), m)
                        : chord ? pow(rest, Real(m) / 2)
                                : pow(4 * mu * rest, Real(m) / 2);
    const Real pi = acos(Real(-1));
    Real azimuth = m == 0 ? 1 / sqrt(2 * pi) : cos(m * at.phi) / sqrt(pi);
    if (name == "esh") azimuth *= sqrt(Real(2));
    if (name == "makhotkin") azimuth *= sqrt(mu);
    const int last = (degree - m) / step;
    const std::vector<Real> p = jacobi(last, a, b, t);
    // h_n by its ratios, from h_0 = 2^{a+b+1} a! b! / (a+b+1)!.
    Real h = 2;
    for (int i = 1; i <= a; ++i) h *= 2 * Real(i) / (b + i + 1);
    for (int i = 1; i <= b; ++i) h *= Real(2) * i / (i + 1);
    std::vector<Real> result(static_cast<std::size_t>(degree - m + 1), Real(0));
    for (int n = 0; n <= last; ++n) {
        if (n > 0)
            h *= Real(n + a) * (n + b) / (Real(n) * (n + a + b)) * (2 * n + a + b - 1) /
                 (2 * n + a + b + 1);
        // The weight (1-t)^a (1+t)^b: hsh, F^{2m} = ((1-t)(1+t))^m, dmu = dt/2; flux, mu^{m+1};
        // zernike, rest^m = ((1+t)/2)^m; in every case T = c F P_n with c^2 h = the factor below.
        const Real weight = sphere  ? Real(1)
                            : flux  ? Real(4)
                            : chord ? 2 * pow(Real(2), m)
                                    : Real(2);
        if (name == "esh" && n % 2 == 1) continue;
        result[static_cast<std::size_t>(n * step)] =
            sqrt(weight / h) * factor * azimuth * p[static_cast<std::size_t>(n)];
    }
    return result;
}

}  // namespace columns
