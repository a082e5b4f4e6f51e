#include <hshfit/light/internal/primaries.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

constexpr std::array<double, 8> rec709{0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
constexpr std::array<double, 8> ofRadiance{0.64, 0.33, 0.29, 0.60, 0.15, 0.06, 1.0 / 3, 1.0 / 3};
/// Lam 1985, as in CIECAM97s: from XYZ to the responses that are scaled.
constexpr ColourMatrix bradford{
    {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

using Colour = std::array<double, 3>;

ColourMatrix product(const ColourMatrix& a, const ColourMatrix& b) {
    ColourMatrix result{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) result[i][j] += a[i][k] * b[k][j];
    return result;
}

Colour product(const ColourMatrix& a, const Colour& v) {
    Colour result{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) result[i] += a[i][k] * v[k];
    return result;
}

/// The inverse by cofactors; none for a singular matrix.
std::optional<ColourMatrix> inverse(const ColourMatrix& a) {
    ColourMatrix cofactors{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
            cofactors[i][j] = a[p][r] * a[q][s] - a[p][s] * a[q][r];
        }
    }
    double determinant = 0;
    for (std::size_t j = 0; j < 3; ++j) determinant += a[0][j] * cofactors[0][j];
    if (!(std::abs(determinant) > 1e-9)) return {};
    ColourMatrix result{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) result[i][j] = cofactors[j][i] / determinant;
    return result;
}

Colour xyzOf(double x, double y) {
    return {x / y, 1, (1 - x - y) / y};
}

/// The matrix from R, G, B to XYZ, with Y = 1 for R = G = B = 1; none for invalid primaries.
std::optional<ColourMatrix> toXyz(const std::array<double, 8>& p) {
    for (std::size_t k = 1; k < p.size(); k += 2)
        if (!(std::abs(p[k]) > 1e-6)) return {};
    ColourMatrix columns{};
    for (std::size_t c = 0; c < 3; ++c) {
        const Colour xyz = xyzOf(p[2 * c], p[2 * c + 1]);
        for (std::size_t i = 0; i < 3; ++i) columns[i][c] = xyz[i];
    }
    const auto back = inverse(columns);
    if (!back) return {};
    const Colour scale = product(*back, xyzOf(p[6], p[7]));
    for (auto& row : columns)
        for (std::size_t c = 0; c < 3; ++c) row[c] *= scale[c];
    return columns;
}

bool alike(const std::array<double, 8>& a, const std::array<double, 8>& b) {
    constexpr double digits = 1e-3;  // files have four
    for (std::size_t k = 0; k < a.size(); ++k)
        if (!(std::abs(a[k] - b[k]) <= digits)) return false;
    return true;
}

}  // namespace

std::optional<ColourMatrix> toRec709(const std::array<double, 8>& primaries) {
    if (alike(primaries, rec709) || alike(primaries, ofRadiance))
        return ColourMatrix{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const auto from = toXyz(primaries);
    const auto to = inverse(*toXyz(rec709)), responses = inverse(bradford);
    if (!from || !to || !responses) return {};
    const Colour white = product(bradford, xyzOf(primaries[6], primaries[7]));
    const Colour wanted = product(bradford, xyzOf(rec709[6], rec709[7]));
    ColourMatrix adapted = bradford;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(white[i] > 0)) return {};
        for (double& value : adapted[i]) value *= wanted[i] / white[i];
    }
    return product(*to, product(product(*responses, adapted), *from));
}

bool isUnit(const ColourMatrix& matrix) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (matrix[i][j] != (i == j ? 1 : 0)) return false;
    return true;
}

}  // namespace hshfit::inline light
