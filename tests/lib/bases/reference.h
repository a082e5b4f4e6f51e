#pragma once

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include <boost/multiprecision/mpfr.hpp>

// An independent evaluation of the bases from their published formulas, by explicit sums in 1200
// digits. The sums of degree 1000 cancel up to some 400 digits. Nothing here is shared with the
// library.
namespace reference {

using Real = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<1200>,
                                           boost::multiprecision::et_off>;

/// A direction in exact arithmetic: from angles, or from the numbers of a vector of any length.
struct Place {
    Real theta, phi;
};

inline Place fromVector(double x, double y, double z) {
    const Real rx = x, ry = y;
    return {atan2(sqrt(rx * rx + ry * ry), Real(z)), x == 0 && y == 0 ? Real(0) : atan2(ry, rx)};
}

/// (last)! / (first)!
inline Real factorialRatio(int last, int first) {
    Real product = 1;
    for (int k = std::min(first, last) + 1; k <= std::max(first, last); ++k) product *= k;
    return last >= first ? product : 1 / product;
}

/// P_n^{(a,b)}(1 - 2 w) as a hypergeometric sum in w (DLMF 18.5.7), w in [0, 1].
inline Real jacobiSum(int n, int a, int b, const Real& w) {
    Real term = factorialRatio(n + a, a) / factorialRatio(n, 0), sum = term;
    for (int k = 0; k < n; ++k) {
        term *= w;
        term *= -static_cast<long>(n - k) * (n + a + b + 1 + k);
        term /= static_cast<long>(a + 1 + k) * (k + 1);
        sum += term;
    }
    return sum;
}

/// The polynomial from the nearer end, by P_n^{(a,b)}(-x) = (-1)^n P_n^{(b,a)}(x).
inline Real jacobi(int n, int a, int b, const Real& w, const Real& oneMinusW) {
    if (w <= oneMinusW) return jacobiSum(n, a, b, w);
    const Real value = jacobiSum(n, b, a, oneMinusW);
    return n % 2 == 0 ? value : -value;
}

/// Zernike's R_q^m as the textbook sum of factorials, rho^2 = w.
inline Real zernikeRadial(int q, int m, const Real& w) {
    const int k = (q - m) / 2, last = (q + m) / 2;
    // From the lowest power up: term_j = (-1)^{k-j} (last+j)! / ((k-j)! (m+j)! j!) rho^{m+2j}.
    Real term = factorialRatio(last, m) / factorialRatio(k, 0) * pow(sqrt(w), m), sum = 0;
    if (k % 2 == 1) term = -term;
    for (int j = 0; j <= k; ++j) {
        sum += term;
        term *= w;
        term *= -static_cast<long>(k - j) * (last + j + 1);
        term /= static_cast<long>(m + j + 1) * (j + 1);
    }
    return sum;
}

/// T_l^m, m >= 0, of the basis called `name`.
inline Real thetaPart(std::string_view name, int l, int m, const Real& theta) {
    const Real mu = cos(theta), half = sin(theta / 2), rest = half * half;  // 1 - mu = 2 rest
    const Real w = 2 * rest;
    if (name == "zernike")
        return (l - m) % 2 ? Real(0) : sqrt(Real(l + 1)) * zernikeRadial(l, m, w);
    if (name == "esh" || name == "sh" || name == "lsosh") {
        if (name == "esh" && (l - m) % 2) return 0;
        // P_l^m = (l+m)!/(2^m l!) sin^m P_{l-m}^{(m,m)}(mu)
        const Real norm = sqrt(Real(2 * l + 1) / (name == "esh" ? 1 : 2) *
                               factorialRatio(l + m, l) / factorialRatio(l, l - m));
        return norm * pow(sin(theta) / 2, m) * jacobi(l - m, m, m, rest, 1 - rest);
    }
    if (name == "hsh") {
        const Real norm =
            sqrt(Real(2 * l + 1) * factorialRatio(l + m, l) / factorialRatio(l, l - m));
        return norm * pow(sqrt(mu * w), m) * jacobi(l - m, m, m, w, mu);
    }
    if (name == "makhotkin" || name == "makhotkin-flux") {
        const Real norm =
            sqrt(Real(2 * l + 2) * factorialRatio(l + m + 1, l + 1) / factorialRatio(l, l - m));
        const Real flux = norm * pow(sqrt(mu * w), m) * jacobi(l - m, m, m + 1, w, mu);
        return name == "makhotkin" ? sqrt(mu) * flux : flux;
    }
    throw std::invalid_argument("no reference for this basis");
}

/// T_l^|m| az_m without the Condon-Shortley phase.
inline Real value(std::string_view name, int l, int m, const Place& place) {
    const Real pi = acos(Real(-1)), t = thetaPart(name, l, abs(m), place.theta);
    if (m == 0) return t / sqrt(2 * pi);
    return t * (m > 0 ? cos(m * place.phi) : sin(-m * place.phi)) / sqrt(pi);
}

}  // namespace reference
