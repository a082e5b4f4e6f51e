#include <hshfit/stability/internal/reference.h>

#include <hshfit/bases/jacobi.h>

#include <cmath>

namespace hshfit::stability {
namespace {

using bases::JacobiFamily;
using Extended = long double;

/// mu and 1 - mu of the unit vector that a rounded vector approximates: from its horizontal
/// part near the pole, from z elsewhere.
struct Position {
    Extended mu, oneMinusMu;
};
Position positionOf(const Direction& d) {
    const Extended x = d.x, y = d.y, z = d.z, r2 = x * x + y * y;
    if (z < 0.7L) return {z, 1 - z};
    const Extended mu = std::sqrt(1 - r2);
    return {mu, r2 / (1 + mu)};
}

/// log |Gamma(x)|. std::lgamma writes the sign into a variable that all threads share.
Extended logGamma(Extended x) {
    int sign = 0;
    return ::lgammal_r(x, &sign);
}

/// c_m, from the integral of T^2 = c^2 F^(2m) W^2 (times mu for projected solid angle) being 1.
Extended startOf(const JacobiFamily& family, int m) {
    const Extended alpha = family.alpha.at(m), beta = family.beta.at(m);
    Extended logarithm = -((alpha + beta + 1) * std::log(2.0L) + logGamma(alpha + 1) +
                           logGamma(beta + 1) - logGamma(alpha + beta + 2));
    const bool shifted = family.argument != JacobiFamily::Argument::cosine;
    const Extended two = std::log(2.0L);
    if (shifted) logarithm += two;  // d mu = dt / 2
    if (family.factor == JacobiFamily::Factor::chord)
        logarithm += m * two;                      // 1 - mu = (1 +- t) / 2
    if (family.timesRootCosine) logarithm += two;  // mu = (1 +- t) / 2
    if (family.inner == Basis::Inner::projectedSolidAngle) logarithm += two;
    if (family.evenOnly) logarithm += two;  // half of the sphere
    return std::exp(logarithm / 2);
}

Extended logFactor(JacobiFamily::Factor factor, const Position& at) {
    switch (factor) {
        case JacobiFamily::Factor::sine:
            return 0.5L * (std::log(at.oneMinusMu) + std::log1p(at.mu));
        case JacobiFamily::Factor::hump:
            return std::log(2.0L) + 0.5L * (std::log(at.mu) + std::log(at.oneMinusMu));
        case JacobiFamily::Factor::chord:
            break;
    }
    return 0.5L * std::log(at.oneMinusMu);
}

Extended argumentOf(JacobiFamily::Argument argument, const Position& at) {
    switch (argument) {
        case JacobiFamily::Argument::cosine:
            return at.oneMinusMu < 0.5L ? 1 - at.oneMinusMu : at.mu;
        case JacobiFamily::Argument::shifted:
            return at.oneMinusMu < 0.5L ? 1 - 2 * at.oneMinusMu : 2 * at.mu - 1;
        case JacobiFamily::Argument::shiftedDown:
            break;
    }
    return at.oneMinusMu < 0.5L ? 2 * at.oneMinusMu - 1 : 1 - 2 * at.mu;
}

struct Recurrence {
    std::vector<Extended> a, b;  ///< b[k] couples p_k and p_{k-1}
};
Recurrence recurrenceOf(Extended alpha, Extended beta, int count) {
    Recurrence r;
    const Extended sum = alpha + beta, difference = (beta - alpha) * (beta + alpha);
    for (int i = 0; i <= count; ++i) {
        const Extended k = i, s = 2 * k + sum;
        r.a.push_back(i == 0 ? (beta - alpha) / (sum + 2) : difference / (s * (s + 2)));
        if (i == 0) {
            r.b.push_back(0);
        } else if (i == 1) {
            const Extended t = sum + 2;
            r.b.push_back(std::sqrt(4 * (alpha + 1) * (beta + 1) / (t * t * (sum + 3))));
        } else {
            r.b.push_back(std::sqrt(4 * k * (k + alpha) * (k + beta) * (k + sum) /
                                    (s * s * (s + 1) * (s - 1))));
        }
    }
    return r;
}

}  // namespace

std::vector<long double> referenceTheta(const JacobiFamily& family, int m, int order,
                                        const std::vector<Direction>& directions) {
    const std::size_t count = directions.size();
    std::vector<Extended> out(static_cast<std::size_t>(order - m) * count, 0);
    const int steps = (order - m + family.bandStep - 1) / family.bandStep;
    const Recurrence r = recurrenceOf(family.alpha.at(m), family.beta.at(m), steps);
    const Extended start = startOf(family, m);
    for (std::size_t p = 0; p < count; ++p) {
        const Position at = positionOf(directions[p]);
        const Extended t = argumentOf(family.argument, at);
        // All factors but the polynomial; exp underflows where the function does.
        Extended scale = m == 0 ? start : start * std::exp(m * logFactor(family.factor, at));
        if (family.timesRootCosine) scale *= std::sqrt(at.mu);
        Extended before = 0, now = 1;
        for (int k = 0; k < steps; ++k) {
            const bool skipped = family.evenOnly && k % 2 != 0;
            if (!skipped)
                out[static_cast<std::size_t>(k * family.bandStep) * count + p] = scale * now;
            const auto i = static_cast<std::size_t>(k);
            const Extended next = ((t - r.a[i]) * now - r.b[i] * before) / r.b[i + 1];
            before = now;
            now = next;
        }
    }
    return out;
}

}  // namespace hshfit::stability
