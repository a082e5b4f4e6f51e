#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/transfer/convolution.h>

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "../bases/reference.h"
#include "quadrature_rules.h"

namespace hshfit {
namespace {

using reference::factorialRatio;
using reference::Real;

constexpr int order = 1001;

/// The integral of t^s P_l(t) over [0, 1] from the powers of P_l (DLMF 18.5.8), in 1200 digits.
Real phongIntegral(int l, double s) {
    Real term = factorialRatio(2 * l, l) / (factorialRatio(l, 0) * pow(Real(2), l)), sum = 0;
    for (int k = 0; 2 * k <= l; ++k) {
        sum += term / (Real(s) + (l - 2 * k + 1));
        // (-1)^k (2l - 2k)! / (2^l k! (l - k)! (l - 2k)!)
        term *= -(l - 2 * k) * (l - 2 * k - 1);
        term /= static_cast<long>(k + 1) * 2 * (2 * l - 2 * k - 1);
    }
    return sum;
}

/// I_{l+1/2}(kappa) / I_{1/2}(kappa): the power series, or the finite sum of half-odd orders (DLMF
/// 10.49.1) where kappa is large.
Real besselRatio(int l, double kappa) {
    const Real x = kappa;
    if (kappa >= 1e4) {
        const auto finite = [&](int n) {
            Real term = 1, sum = 0;
            for (int k = 0; k <= n; ++k) {
                sum += term;
                term *= -Real(n + k + 1) * (n - k) / (2 * x * (k + 1));
            }
            return sum;  // exp(-kappa) vanishes in 1200 digits only from 2763 on
        };
        return finite(l) / finite(0);
    }
    const auto series = [&](int n) {
        Real term = 1, sum = 0;
        for (int k = 0; k < 4000; ++k) {
            sum += term;
            term *= x * x / (Real(4) * (k + 1) * (Real(n + k) + Real(1.5)));
        }
        return sum;
    };
    Real front = 1;
    for (int k = 1; k <= l; ++k) front *= x / (2 * k + 1);
    return front * series(l) / series(0);
}

const int degrees_[] = {0, 1, 2, 3, 4, 9, 10, 57, 100, 333, 500, 999, 1000};

void expectRelative(double value, const Real& exact, double tolerance) {
    if (abs(exact) < std::numeric_limits<double>::min()) {
        EXPECT_LE(std::abs(value), std::numeric_limits<double>::min());
        return;
    }
    EXPECT_LE(static_cast<double>(abs(value / exact - 1)), tolerance) << exact;
}

TEST(Convolution, PhongAndClampedCosineMatchSumsIn1200Digits) {
    const Real twoPi = 8 * atan(Real(1));
    for (const double s : {0.0, 0.5, 1.0, 2.0, 7.0, 36.25, 1000.0, 1e6}) {
        const std::vector<double> lambda = phongLobe(order, s);
        for (const int l : degrees_) {
            SCOPED_TRACE(testing::Message() << "l " << l << " s " << s);
            const Real exact = twoPi * phongIntegral(l, s);
            // Zero by symmetry: an even power and even l, and the like.
            const bool zero = s == std::floor(s) && l > s && (l - static_cast<int>(s)) % 2 == 0;
            if (zero) {
                EXPECT_EQ(lambda[l], 0);
                continue;
            }
            expectRelative(lambda[l], exact, 1e-12);
        }
    }
    const std::vector<double> cosine = clampedCosine(order);
    for (const int l : degrees_) {
        if (l > 1 && l % 2 == 1) {
            EXPECT_EQ(cosine[l], 0);
        } else {
            expectRelative(cosine[l], twoPi * phongIntegral(l, 1), 1e-12);
        }
    }
}

TEST(Convolution, VonMisesFisherMatchesBesselFunctionsIn1200Digits) {
    for (const double kappa : {1e-160, 1e-6, 0.5, 3.0, 100.0, 1e4, 1e6, 1e9}) {
        const std::vector<double> lambda = vonMisesFisher(order, kappa);
        for (const int l : degrees_) {
            SCOPED_TRACE(testing::Message() << "l " << l << " kappa " << kappa);
            expectRelative(lambda[l], besselRatio(l, kappa), 1e-12);
        }
    }
    EXPECT_EQ(vonMisesFisher(3, 0), (std::vector<double>{1, 0, 0}));
}

TEST(Convolution, HeatKernelsOfTwoWidthsConvolveToOne) {
    const auto a = heatKernel(order, 0.03), b = heatKernel(order, 0.04), c = heatKernel(order, .05);
    for (int l = 0; l < order; ++l) {
        EXPECT_NEAR(a[l] * b[l], c[l], 1e-12 * c[l]);
        expectRelative(c[l], exp(-Real(0.05) * Real(0.05) * l * (l + 1) / 2), 1e-12);
    }
    EXPECT_EQ(heatKernel(4, 0), (std::vector<double>(4, 1.0)));
}

/// A function of one angle for `multipliersOf`.
template <class F>
AngleFunction byAngle(F f) {
    return [f](std::span<const double> angles, double* out) {
        for (std::size_t k = 0; k < angles.size(); ++k) out[k] = f(angles[k]);
    };
}

void expectNear(const std::vector<double>& values, const std::vector<double>& exact, double most) {
    for (std::size_t l = 0; l < exact.size(); ++l) {
        EXPECT_NEAR(values[l], exact[l], most * exact[0]) << "l " << l;
    }
}

TEST(Convolution, QuadratureOfAnyKernelMatchesTheClosedForms) {
    const auto clamped = [](double a) { return std::max(0.0, std::cos(a)); };
    expectNear(multipliersOf(byAngle(clamped), order, {.breaks = {pi / 2}}), clampedCosine(order),
               1e-12);
    // Without the break panels are halved towards the kink.
    expectNear(multipliersOf(byAngle(clamped), order), clampedCosine(order), 1e-12);
    for (const double s : {3.5, 22.0, 1e4, 1e6}) {
        const auto lobe = [s](double a) { return std::pow(std::max(0.0, std::cos(a)), s); };
        expectNear(multipliersOf(byAngle(lobe), order, {.last = pi / 2}), phongLobe(order, s),
                   1e-12);
    }
    for (const double kappa : {2.0, 1e4, 1e7}) {
        const auto density = [kappa](double a) {
            const double sine = std::sin(a / 2);
            return kappa / (2 * pi) * std::exp(-2 * kappa * sine * sine) / -std::expm1(-2 * kappa);
        };
        expectNear(multipliersOf(byAngle(density), order), vonMisesFisher(order, kappa), 1e-12);
    }
}

TEST(Convolution, DiscsHaveDifferencesOfLegendrePolynomials) {
    for (const double radius : {0.2665 * pi / 180, 0.1, 1.0, 2.5}) {
        const auto disc = [radius](double a) { return a <= radius ? 1.0 : 0.0; };
        // (P_{l-1} - P_{l+1}) 2 pi / (2l + 1), by the recurrence in 1200 digits.
        std::vector<double> exact;
        const Real x = cos(Real(radius)), twoPi = 8 * atan(Real(1));
        std::vector<Real> p{1, x};
        for (int l = 1; l <= order; ++l)
            p.push_back(((2 * l + 1) * x * p[l] - l * p[l - 1]) / (l + 1));
        for (int l = 0; l < order; ++l) {
            const Real before = l > 0 ? p[l - 1] : Real(1);
            exact.push_back(static_cast<double>(twoPi * (before - p[l + 1]) / (2 * l + 1)));
        }
        expectNear(multipliersOf(byAngle(disc), order, {.breaks = {radius}}), exact, 1e-12);
        expectNear(multipliersOf(byAngle(disc), order), exact, 1e-11);
    }
}

TEST(Convolution, ConvolvedFunctionIsTheIntegralAgainstTheTurnedKernel) {
    for (const bool phase : {false, true}) {
        const auto basis = bases::make("sh", 6, {.condonShortley = phase});
        std::mt19937_64 random(7);
        std::normal_distribution<double> normal;
        std::vector<double> f(36), values(36);
        for (double& value : f) value = normal(random);
        std::vector<double> convolved = f;
        convolve(convolved, vonMisesFisher(6, 5));
        const double kappa = 5, front = kappa / (4 * pi * std::sinh(kappa));
        const Direction n = directionFromAngles(1.1, 0.4);
        double integral = 0;
        rules::eachPoint(64, 128, true, [&](const Direction& w, double weight) {
            basis->evaluate(w, values.data());
            double sum = 0;
            for (int i = 0; i < 36; ++i) sum += f[i] * values[i];
            integral += weight * sum * front * std::exp(kappa * dot(n, w));
        });
        basis->evaluate(n, values.data());
        double expected = 0;
        for (int i = 0; i < 36; ++i) expected += convolved[i] * values[i];
        EXPECT_NEAR(integral, expected, 1e-12);
    }
}

TEST(Convolution, CatalogNamesDomainsAndRefusals) {
    for (const Kernel& kernel : kernelCatalog()) {
        const auto lambda = kernelMultipliers(kernel.name, 5, 1);
        ASSERT_EQ(lambda.size(), 5u);
        if (kernel.density) {
            EXPECT_DOUBLE_EQ(lambda[0], 1) << kernel.name;
        }
        if (std::isfinite(kernel.most)) {
            EXPECT_THROW(kernelMultipliers(kernel.name, 5, kernel.most * 1.01), UsageError);
            EXPECT_THROW(kernelMultipliers(kernel.name, 5, kernel.least - 1), UsageError);
            EXPECT_THROW(kernelMultipliers(kernel.name, 5, std::nan("")), UsageError);
        }
        EXPECT_THROW(kernelMultipliers(kernel.name, 0, 1), UsageError);
    }
    EXPECT_THROW(kernelMultipliers("box", 5, 1), UsageError);
    const auto pole = [](double a) { return 1 / (a * 0); };
    EXPECT_THROW(multipliersOf(byAngle(pole), 5), NumericError);
    std::mt19937 random(1);
    const auto noise = [&random](double) { return static_cast<double>(random()); };
    EXPECT_THROW(multipliersOf(byAngle(noise), 5), NumericError);
    std::vector<double> five(5), four(4);
    EXPECT_THROW(convolve(five, four), UsageError);
    EXPECT_THROW(convolve(four, std::vector<double>{1}), UsageError);
    EXPECT_EQ(zonalCoefficients(std::vector<double>{1})[0], 1 / std::sqrt(4 * pi));
}

}  // namespace
}  // namespace hshfit
