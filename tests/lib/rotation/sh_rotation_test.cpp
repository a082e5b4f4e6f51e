// Rotation of spherical harmonics: both routes against the functions themselves, against each
// other, and against Wigner's sum in many digits.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/rotation/band_matrix.h>
#include <hshfit/rotation/sh_rotation.h>

#include <lib/rotation/random.h>

#include <gtest/gtest.h>
#include <boost/multiprecision/mpfr.hpp>

#include <limits>

namespace {

using namespace hshfit;
using hshfit::test::distance;
using hshfit::test::normOf;
using hshfit::test::Random;

double valueAt(const Basis& basis, const std::vector<double>& c, const Direction& d) {
    std::vector<double> values(static_cast<std::size_t>(basis.slots()));
    basis.evaluate(d, values.data());
    double sum = 0;
    for (std::size_t i = 0; i < c.size(); ++i) sum += c[i] * values[i];
    return sum;
}

std::vector<double> byBands(const Rotation& rotation, const std::vector<double>& c, int order,
                            bool condonShortley = false) {
    std::vector<double> result(c.size());
    for (int l = 0; l < order; ++l) {
        const std::vector<double> d = bandMatrix(l, rotation, condonShortley);
        const auto width = static_cast<std::size_t>(2 * l + 1),
                   first = static_cast<std::size_t>(l) * l;
        for (std::size_t i = 0; i < width; ++i)
            for (std::size_t j = 0; j < width; ++j)
                result[first + i] += d[i * width + j] * c[first + j];
    }
    return result;
}

std::vector<Rotation> specialRotations() {
    return {Rotation(),
            Rotation::euler(0.3, 0, 0),
            Rotation::euler(0.3, pi, -1),
            Rotation::euler(0, pi / 2, 0),
            Rotation::euler(1, 1e-7, 2),
            Rotation::euler(1, 1e-200, 2),
            Rotation::euler(1, pi - 1e-5, 2),
            Rotation::euler(-2, 0.02, 0.5)};
}

struct Bound {
    int order;
    double error;
};
constexpr Bound bounds[] = {{1, 4e-15},  {2, 4e-15},   {3, 4e-15},   {10, 1e-14},
                            {11, 1e-14}, {100, 1e-13}, {300, 1e-12}, {1000, 1e-11}};

TEST(ShRotation, RotatedFunctionIsTheFunctionAtTurnedDirections) {
    for (const auto& [order, bound] : bounds) {
        Random random(static_cast<std::uint64_t>(order));
        const ShRotation rotate(order);
        const auto basis = bases::make("sh", order);
        const std::vector<double> c = random.vector(static_cast<std::size_t>(basis->slots()));
        // The root mean square of the function over the sphere.
        const double size = normOf(c) / std::sqrt(4 * pi);
        std::vector<Rotation> rotations;
        if (order < 1000) rotations = specialRotations();
        rotations.push_back(random.rotation());
        for (const Rotation& r : rotations) {
            const std::vector<double> turned = rotate.rotate(r, c);
            for (int k = 0; k < 3; ++k) {
                const Direction d = random.direction();
                EXPECT_NEAR(valueAt(*basis, turned, d), valueAt(*basis, c, r.inverse()(d)),
                            bound * size)
                    << order;
            }
        }
    }
}

TEST(ShRotation, RotationsComposeAndKeepNorms) {
    for (const auto& [order, bound] : bounds) {
        Random random(static_cast<std::uint64_t>(order) + 100);
        const ShRotation rotate(order);
        const std::vector<double> c = random.vector(static_cast<std::size_t>(order) * order);
        const Rotation first = random.rotation(), second = random.rotation();
        const std::vector<double> once = rotate.rotate(first, c),
                                  twice = rotate.rotate(second, once);
        const double composed = distance(twice, rotate.rotate(second * first, c)) / normOf(c);
        EXPECT_LT(composed, bound) << order;
        const double undone = distance(rotate.rotate(first.inverse(), once), c) / normOf(c);
        EXPECT_LT(undone, bound) << order;
        double worst = 0;  // of the norm of one band
        for (int l = 0; l < order; ++l) {
            double before = 0, after = 0;
            for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
                before += c[static_cast<std::size_t>(i)] * c[static_cast<std::size_t>(i)];
                after += twice[static_cast<std::size_t>(i)] * twice[static_cast<std::size_t>(i)];
            }
            worst = std::max(worst, std::abs(std::sqrt(after / before) - 1));
        }
        EXPECT_LT(worst, bound) << order;
    }
}

TEST(ShRotation, BothRoutesAgree) {
    for (const auto& [order, bound] : bounds) {
        if (order > 300) continue;
        Random random(static_cast<std::uint64_t>(order) + 200);
        const std::vector<double> c = random.vector(static_cast<std::size_t>(order) * order);
        std::vector<Rotation> rotations = {random.rotation()};
        if (order <= 100) {
            for (const Rotation& r : specialRotations()) rotations.push_back(r);
        }
        for (const bool sign : {false, true}) {
            const ShRotation rotate(order, {.condonShortley = sign});
            for (const Rotation& r : rotations)
                EXPECT_LT(distance(rotate.rotate(r, c), byBands(r, c, order, sign)),
                          bound * normOf(c))
                    << order;
        }
    }
}

TEST(ShRotation, VectorsOfABatchAreIndependent) {
    Random random(7);
    for (const int order : {1, 2, 3, 5, 10, 13}) {
        const ShRotation rotate(order);
        const auto slots = static_cast<std::size_t>(order) * order;
        for (const std::size_t channels : {1u, 3u}) {
            std::vector<Rotation> rotations;
            for (int i = 0; i < 23; ++i) rotations.push_back(random.rotation());
            const std::size_t count = rotations.size() * channels;
            std::vector<double> in = random.vector(count * slots), out(in.size());
            rotate.rotate(rotations, channels, in.data(), out.data());
            for (std::size_t k = 0; k < count; ++k) {
                const std::vector<double> one(
                    in.begin() + static_cast<std::ptrdiff_t>(k * slots),
                    in.begin() + static_cast<std::ptrdiff_t>((k + 1) * slots));
                const std::vector<double> alone = rotate.rotate(rotations[k / channels], one);
                for (std::size_t i = 0; i < slots; ++i) EXPECT_EQ(alone[i], out[k * slots + i]);
            }
            rotate.rotate(rotations, channels, in.data(), in.data());
            EXPECT_EQ(in, out);
        }
    }
}

TEST(ShRotation, SignOfTheSourcesIsKept) {
    Random random(8);
    const int order = 14;
    const auto basis = bases::make("sh", order, {.condonShortley = true});
    const ShRotation rotate(order, {.condonShortley = true});
    const std::vector<double> c = random.vector(static_cast<std::size_t>(order) * order);
    for (int i = 0; i < 10; ++i) {
        const Rotation r = random.rotation();
        const Direction d = random.direction();
        EXPECT_NEAR(valueAt(*basis, rotate.rotate(r, c), d), valueAt(*basis, c, r.inverse()(d)),
                    1e-13 * normOf(c));
    }
}

/// d^l_(m,k)(beta) by Wigner's sum.
double wignerSum(int l, int m, int k, double beta) {
    using Real = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<700>>;
    const auto factorial = [](int n) {
        Real product = 1;
        for (int i = 2; i <= n; ++i) product *= i;
        return product;
    };
    const Real c = cos(Real(beta) / 2), s = sin(Real(beta) / 2);
    // The first term, then ratios of neighbours.
    const int first = std::max(0, k - m), last = std::min(l + k, l - m);
    Real term = factorial(l + m) * factorial(l - m) * factorial(l + k) * factorial(l - k);
    term = sqrt(term) / (factorial(l + k - first) * factorial(first) * factorial(m - k + first) *
                         factorial(l - m - first));
    term *= pow(c, 2 * l + k - m - 2 * first) * pow(s, m - k + 2 * first);
    if ((m - k + first) % 2 != 0) term = -term;
    Real sum = 0;
    const Real ratio = s * s / (c * c);
    for (int i = first; i <= last; ++i) {
        sum += term;
        term *= -ratio * (l + k - i) * (l - m - i) / (Real(i + 1) * (m - k + i + 1));
    }
    return static_cast<double>(sum);
}

TEST(ShRotation, BandsAreWignersSums) {
    Random random(9);
    for (const int l : {1, 2, 7, 50, 300, 999}) {
        for (const double beta : {1e-6, 0.01, 0.7, pi / 2, 2.2, 3.1415}) {
            const std::vector<double> d = bandMatrix(l, Rotation::euler(0, beta, 0));
            const auto width = static_cast<std::size_t>(2 * l + 1);
            double worst = 0;
            for (int i = 0; i < (l > 100 ? 8 : 40); ++i) {
                const int m = std::abs(static_cast<int>(random.normal() * l)) % (l + 1);
                const int k = i % 2 == 0
                                  ? m - std::min(m, i / 2)
                                  : std::abs(static_cast<int>(random.normal() * l)) % (l + 1);
                // Cosine by cosine: (-1)^(m+k) d_(m,k) + (-1)^m d_(m,-k), with sqrt(1/2) for m or
                // k = 0; Condon-Shortley signs are in d.
                const double scale = (m == 0 ? std::sqrt(0.5) : 1) * (k == 0 ? std::sqrt(0.5) : 1);
                const double expected =
                    scale * (((m + k) % 2 == 0 ? 1 : -1) * wignerSum(l, m, k, beta) +
                             (m % 2 == 0 ? 1 : -1) * wignerSum(l, m, -k, beta));
                const double found =
                    d[static_cast<std::size_t>(l + m) * width + static_cast<std::size_t>(l + k)];
                worst = std::max(worst, std::abs(found - expected));
            }
            EXPECT_LT(worst, 1e-14) << l << " " << beta;
        }
    }
}

TEST(ShRotation, RefusesOrdersThatItCannotRotate) {
    EXPECT_THROW(ShRotation(0), UsageError);
    EXPECT_THROW(ShRotation(1001), UsageError);
    EXPECT_THROW(bandMatrix(-1, Rotation()), UsageError);
    EXPECT_THROW(ShRotation(3).rotate(Rotation(), std::vector<double>(8)), UsageError);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    // A value that is not finite stays in its band.
    std::vector<double> c(16 * 16, 1.0);
    c[3] = nan;
    c[13 * 13] = nan;
    const std::vector<double> turned = ShRotation(16).rotate(Rotation::euler(1, 1, 1), c);
    for (std::size_t i = 0; i < c.size(); ++i)
        EXPECT_EQ(std::isnan(turned[i]), (i >= 1 && i < 4) || (i >= 169 && i < 196)) << i;
    ShRotation(4).rotate({}, 3, nullptr, nullptr);
}

}  // namespace
