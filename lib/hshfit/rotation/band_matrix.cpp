#include <hshfit/rotation/band_matrix.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

namespace hshfit::inline rotation {
namespace {

/// Exponents of a column count in these powers of 2.
constexpr int shift = 512;

/// One row of a_(m,k), k = -l .. l, each with an exponent of its own: value 2^(shift exponent).
struct ScaledRow {
    std::vector<double> value;
    std::vector<int> exponent;
};

/// sqrt(binomial(2l, l + k)) cos(beta/2)^(l+k) sin(beta/2)^(l-k), by products from k = l.
ScaledRow startRow(int l, long double cosHalf, long double sinHalf) {
    ScaledRow row{std::vector<double>(static_cast<std::size_t>(2 * l) + 1),
                  std::vector<int>(static_cast<std::size_t>(2 * l) + 1)};
    long double value = std::pow(cosHalf, 2 * l);
    const long double tangent = sinHalf / cosHalf;
    long exponent = 0;
    for (int k = l; k >= -l; --k) {
        int more = 0;
        value = std::frexp(value, &more);
        exponent += more;
        const long whole = exponent < 0 ? -exponent / shift : 0;
        const auto at = static_cast<std::size_t>(l + k);
        row.value[at] =
            std::ldexp(static_cast<double>(value), static_cast<int>(exponent + whole * shift));
        row.exponent[at] = -static_cast<int>(whole);
        value *= tangent * std::sqrt(static_cast<long double>(l + k) / (l - k + 1));
    }
    return row;
}

/// a_(m,k) = (-1)^(m+k) d^l_(m,k)(beta), [m][l + k] for m = 0 .. l and |k| <= m, 0 < beta <= pi/2.
std::vector<double> wedge(int l, const Rotation::Turns& t) {
    const auto width = static_cast<std::size_t>(2 * l) + 1;
    std::vector<double> a(static_cast<std::size_t>(l + 1) * width);
    const long double cosHalf = std::sqrt(1 - t.oneMinusCosBeta / 2.0L);
    ScaledRow row = startRow(l, cosHalf, t.sinBeta / (2 * cosHalf));
    std::vector<double> last(width, 0.0);
    const double big = std::ldexp(1.0, shift / 2), small = std::ldexp(1.0, -shift);
    for (int m = l;; --m) {
        double* to = a.data() + static_cast<std::size_t>(m) * width;
        for (int k = -m; k <= m; ++k) {
            const auto at = static_cast<std::size_t>(l + k);
            to[at] = row.exponent[at] == 0 ? row.value[at] : 0;
        }
        if (m == 0) return a;
        const double g = std::sqrt((l + m) * (l - m + 1.0));
        const double carry = std::sqrt((l - m) * (l + m + 1.0)) / g;
        const double slope = 2 / (t.sinBeta * g);
        for (int k = 1 - m; k < m; ++k) {
            const auto at = static_cast<std::size_t>(l + k);
            // m cos(beta) - k without cancellation at small angles.
            double next =
                slope * ((m - k) - m * t.oneMinusCosBeta) * row.value[at] - carry * last[at];
            double here = row.value[at];
            if (row.exponent[at] < 0 && std::abs(next) > big) {
                next *= small;
                here *= small;
                ++row.exponent[at];
            }
            last[at] = here;
            row.value[at] = next;
        }
    }
}

/// Rotation about y by beta: cosines (m, k >= 0) at [m (l + 1) + k], and sines.
struct TiltMatrix {
    std::vector<double> cosine, sine;
};

TiltMatrix tiltMatrix(int l, Rotation::Turns t) {
    const auto size = static_cast<std::size_t>(l) + 1, width = static_cast<std::size_t>(2 * l) + 1;
    TiltMatrix result{std::vector<double>(size * size), std::vector<double>(size * size)};
    const bool beyond = t.cosBeta < 0;
    if (beyond) t.oneMinusCosBeta = t.sinBeta * t.sinBeta / (1 - t.cosBeta);
    // A smaller angle changes nothing in double precision.
    const bool none = t.sinBeta < 1e-20;
    const std::vector<double> a = none ? std::vector<double>() : wedge(l, t);
    const auto sign = [](int m) { return m % 2 == 0 ? 1.0 : -1.0; };
    const auto at = [&](int m, int k) {
        // a_(m,k)(pi - beta) = (-1)^(l-m) a_(m,-k)(beta)
        const int column = beyond ? -k : k;
        const double value =
            none ? (m == column ? 1.0 : 0.0)
                 : a[static_cast<std::size_t>(m) * width + static_cast<std::size_t>(l + column)];
        return beyond ? sign(l - m) * value : value;
    };
    for (int m = 0; m <= l; ++m)
        for (int k = 0; k <= m; ++k) {
            const double scale =
                (m == 0 ? std::numbers::sqrt2 / 2 : 1) * (k == 0 ? std::numbers::sqrt2 / 2 : 1);
            const double plus = scale * at(m, k), minus = scale * sign(k) * at(m, -k);
            const std::size_t below = static_cast<std::size_t>(m) * size + k,
                              above = static_cast<std::size_t>(k) * size + m;
            result.cosine[above] = sign(m + k) * (plus + minus);
            result.sine[above] = sign(m + k) * (plus - minus);
            result.cosine[below] = plus + minus;
            result.sine[below] = plus - minus;
        }
    return result;
}

/// (cos(m angle), sin(m angle)), m = 0 .. l.
std::vector<std::pair<double, double>> multiples(int l, double cosine, double sine) {
    const double angle = std::atan2(sine, cosine);
    std::vector<std::pair<double, double>> result;
    for (int m = 0; m <= l; ++m) result.emplace_back(std::cos(m * angle), std::sin(m * angle));
    return result;
}

}  // namespace

std::vector<double> bandMatrix(int l, const Rotation& rotation, bool condonShortley) {
    if (l < 0) throw UsageError(fmt::format("band {} of a rotation; it has to be at least 0", l));
    const Rotation::Turns t = rotation.turns();
    const TiltMatrix tilt = tiltMatrix(l, t);
    const auto alpha = multiples(l, t.cosAlpha, t.sinAlpha);
    const auto gamma = multiples(l, t.cosGamma, t.sinGamma);
    const auto width = static_cast<std::size_t>(2 * l) + 1, size = static_cast<std::size_t>(l) + 1;
    std::vector<double> d(width * width);
    for (int m = 0; m <= l; ++m)
        for (int k = 0; k <= l; ++k) {
            const auto from = static_cast<std::size_t>(m) * size + static_cast<std::size_t>(k);
            const auto [ca, sa] = alpha[static_cast<std::size_t>(m)];
            const auto [cg, sg] = gamma[static_cast<std::size_t>(k)];
            const double sign = condonShortley && (m + k) % 2 != 0 ? -1 : 1;
            const double c = sign * tilt.cosine[from], s = sign * tilt.sine[from];
            const auto to = [&](int row, int column) -> double& {
                return d[static_cast<std::size_t>(l + row) * width +
                         static_cast<std::size_t>(l + column)];
            };
            to(m, k) = ca * c * cg - sa * s * sg;
            if (m > 0) to(-m, k) = sa * c * cg + ca * s * sg;
            if (k > 0) to(m, -k) = -ca * c * sg - sa * s * cg;
            if (m > 0 && k > 0) to(-m, -k) = -sa * c * sg + ca * s * cg;
        }
    return d;
}

}  // namespace hshfit::inline rotation
