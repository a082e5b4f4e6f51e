// Fresnel's equations against Snell's law in complex long doubles, and against what follows from
// them at single angles.

#include <brdfs/analytic/fresnel.h>
#include <gtest/gtest.h>
#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <initializer_list>

namespace hshfit::brdfs {
namespace {

using Number = std::complex<long double>;

/// Amplitudes from the refracted angle, which the code under test never forms.
long double bySnell(long double cosine, Number n) {
    const Number sine = std::sqrt(1 - cosine * cosine) / n, inside = std::sqrt(1.0L - sine * sine);
    const Number s = (cosine - n * inside) / (cosine + n * inside);
    const Number p = (n * cosine - inside) / (n * cosine + inside);
    return (std::norm(s) + std::norm(p)) / 2;
}

TEST(Fresnel, FollowsSnellsLaw) {
    for (const double eta : {.2, .66, .9, 1.0001, 1.1, 1.33, 1.5, 2.4, 4., 50.})
        for (const double k : {0., 1e-6, .01, .5, 1.5, 3.4, 8., 100.})
            for (int i = 1; i <= 90; ++i) {
                const double c = i == 90 ? 1 : std::sin(radians(i));
                const double expected = static_cast<double>(bySnell(c, {eta, k}));
                // At the critical angle itself the slope is infinite.
                ASSERT_NEAR(conductorReflectance(c, eta, k), expected, 1e-13 * expected + 1e-17)
                    << eta << " " << k << " " << c;
                if (k == 0) {
                    ASSERT_EQ(dielectricReflectance(c, eta), conductorReflectance(c, eta, 0));
                }
            }
}

TEST(Fresnel, NormalIncidenceIsTheClosedForm) {
    for (const double n : {.5, 1., 1.33, 1.5, 2.42}) {
        const double expected = (n - 1) / (n + 1) * ((n - 1) / (n + 1));
        EXPECT_NEAR(dielectricReflectance(1, n), expected, 1e-15);
        EXPECT_NEAR(schlickReflectance(1, expected), expected, 1e-15);
        EXPECT_NEAR(normalReflectance(n), expected, 1e-15);
        if (n >= 1) {
            EXPECT_NEAR(iorOfReflectance(expected), n, 1e-12);
        }
    }
    EXPECT_NEAR(conductorReflectance(1, 1.2, 7), (.2 * .2 + 49) / (2.2 * 2.2 + 49), 1e-15);
    EXPECT_NEAR(normalReflectance(1.2, 7), (.2 * .2 + 49) / (2.2 * 2.2 + 49), 1e-15);
}

// tan = n: nothing of the component in the plane returns, ((n^2 - 1)/(n^2 + 1))^2 of the other.
TEST(Fresnel, BrewstersAngle) {
    for (const double n : {.4, .75, 1.33, 1.5, 3.}) {
        const double across = (n * n - 1) / (n * n + 1);
        EXPECT_NEAR(dielectricReflectance(1 / std::hypot(1, n), n), across * across / 2, 1e-15);
    }
}

// From either side along the same path: c and eta, or the refracted c and 1 / eta.
TEST(Fresnel, SameFromBothSides) {
    for (const double n : {1.1, 1.5, 2.4})
        for (int i = 1; i < 100; ++i) {
            const double c = i / 100., refracted = std::sqrt(1 - (1 - c * c) / (n * n));
            EXPECT_NEAR(dielectricReflectance(c, n), dielectricReflectance(refracted, 1 / n),
                        1e-12);
        }
}

TEST(Fresnel, TotalReflectionOnlyFromTheDenserSide) {
    for (const double n : {.4, .66, .9}) {
        const double critical = std::sqrt(1 - n * n);
        for (const double part : {0., .1, .5, .99, 1 - 1e-9})
            EXPECT_DOUBLE_EQ(dielectricReflectance(critical * part, n), 1);
        for (const double above : {1e-6, .01, .1})
            EXPECT_LT(dielectricReflectance(critical + above, n), 1 - 1e-3);
    }
    for (const double n : {1., 1.0001, 1.5, 1000.})
        for (const double c : {1e-12, .01, .5, 1.}) EXPECT_LT(dielectricReflectance(c, n), 1);
}

TEST(Fresnel, FiniteAtEveryEnd) {
    for (const double c : {0., 5e-324, 1e-300, 1e-150, 1e-9, 1 - 1e-16, 1., 1 + 1e-15})
        for (const double eta : {1e-6, .5, 1., 1 + 1e-15, 1.5, 1e6})
            for (const double k : {0., 1e-300, 1e-9, 1., 1e6}) {
                const double value = conductorReflectance(c, eta, k);
                ASSERT_GE(value, 0) << c << " " << eta << " " << k;
                ASSERT_LE(value, 1) << c << " " << eta << " " << k;
            }
    EXPECT_EQ(dielectricReflectance(0, 1), 0) << "no boundary";
    EXPECT_EQ(dielectricReflectance(0, 1.5), 1) << "the horizon";
    EXPECT_EQ(schlickReflectance(0, .04), 1);
}

// The error of Schlick's approximation that the header states.
TEST(Fresnel, SchlickIsWithinItsStatedError) {
    double worst = 0;
    for (int n = 120; n <= 220; n += 5)
        for (int i = 0; i <= 1000; ++i) {
            const double c = i / 1000.;
            worst = std::max(worst, std::abs(dielectricReflectance(c, n / 100.) -
                                             schlickReflectance(c, normalReflectance(n / 100.))));
        }
    EXPECT_LT(worst, .12);
    EXPECT_GT(worst, .1) << "the header could say less";
}

// The denser mirror reflects more at normal incidence; towards grazing everything reflects all.
TEST(Fresnel, GrowsTowardsGrazingForDielectrics) {
    for (const double n : {1.1, 1.5, 2.4}) {
        double before = dielectricReflectance(1, n);
        for (int i = 999; i >= 0; --i) {
            const double value = dielectricReflectance(i / 1000., n);
            ASSERT_GE(value, before - 1e-15);
            before = value;
        }
    }
}

}  // namespace
}  // namespace hshfit::brdfs
