#include "../asymmetric.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/bases/sh.h>
#include <hshfit/error.h>
#include <hshfit/gpu/internal/basis_steps.h>
#include <hshfit/light/environment_matrix.h>

#include <gtest/gtest.h>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/legendre.hpp>

#include <cmath>
#include <iostream>

namespace hshfit::gpu {
namespace {

/// The steps of the snippets, in single precision: every function of `order`^2 slots.
std::vector<float> evaluateSteps(const BasisSteps& steps, int order, const Direction& d) {
    const auto x = static_cast<float>(d.x), y = static_cast<float>(d.y),
               z = static_cast<float>(d.z);
    const float o = (x * x + y * y) / (1 + z);
    const bool horizon = steps.bothEnds && o >= z;
    const float t = !steps.bothEnds
                        ? -o
                        : (horizon ? 2.f : -2.f) * static_cast<float>(steps.near) * std::min(o, z);
    const float s = steps.scale == BasisSteps::Scale::hump    ? 2 * std::sqrt(z / (1 + z))
                    : steps.scale == BasisSteps::Scale::chord ? 1 / std::sqrt(1 + z)
                                                              : 1.f;
    float re = steps.rootCosine ? std::sqrt(z) : 1.f, im = 0;
    std::vector<float> values(static_cast<std::size_t>(order * order), 0.f);
    for (const BasisSteps::Column& column : steps.columns) {
        auto p = static_cast<float>(column.start);
        float carried = 0;
        const std::size_t count = column.steps.size();
        for (std::size_t k = 0; k <= count; ++k) {
            const int l = column.m + static_cast<int>(k) * steps.bandStep;
            values[static_cast<std::size_t>(slotOf(l, column.m))] = p * re;
            if (column.m > 0) values[static_cast<std::size_t>(slotOf(l, -column.m))] = p * im;
            if (k == count) break;
            const BasisSteps::Step& step = column.steps[k];
            carried = static_cast<float>(step.slope) * t * p +
                      static_cast<float>(step.carry[horizon]) * carried;
            p = static_cast<float>(step.ratio[horizon]) * p + carried;
        }
        const float next = re * s * x - im * s * y;
        im = re * s * y + im * s * x;
        re = next;
    }
    return values;
}

/// Largest error of any function of any order, of the largest value that the function takes.
double worstError(const bases::Entry& entry, const std::vector<Direction>& directions) {
    double worst = 0;
    for (int order = 1; order <= std::min(18, entry.maxOrder); ++order) {
        const auto basis = entry.make(order, {.condonShortley = order % 2 == 0});
        const BasisSteps steps = basisSteps(*basis);
        const auto slots = static_cast<std::size_t>(basis->slots());
        std::vector<double> expected(slots), error(slots, 0.0), size(slots, 1e-3);
        for (const Direction& d : directions) {
            const std::vector<float> found = evaluateSteps(steps, order, d);
            basis->evaluate(d, expected.data());
            for (int l = 0; l < order; ++l) {
                for (int m = -l; m <= l; ++m) {
                    if (!basis->has(l, m)) continue;
                    const auto slot = static_cast<std::size_t>(slotOf(l, m));
                    const double off = static_cast<double>(found[slot]) - expected[slot];
                    error[slot] = std::max(error[slot], std::abs(off));
                    size[slot] = std::max(size[slot], std::abs(expected[slot]));
                }
            }
        }
        for (std::size_t slot = 0; slot < slots; ++slot)
            worst = std::max(worst, error[slot] / size[slot]);
    }
    return worst;
}

TEST(BasisSteps, SinglePrecisionAgreesWithEveryBasis) {
    const std::vector<Direction> directions = samples::floatDirections(400, 3);
    for (const bases::Entry& entry : bases::catalog()) {
        if (entry.name == "slepian") continue;  // no recurrence: see the next test
        const double worst = worstError(entry, directions);
        std::cout << entry.name << ": " << worst << '\n';
        // A step and a power of u round four times each, by 6e-8 at most; 17 of them.
        EXPECT_LE(worst, 4 * 17 * 6e-8) << entry.name;
    }
}

TEST(BasisSteps, ABasisWithoutARecurrenceIsRefused) {
    EXPECT_THROW(basisSteps(*bases::make("slepian", 3)), UsageError);
}

/// The integrals of B_k Y_j [cos theta] over the hemisphere in both angles, [row][column], by 60
/// Gauss points in u = sqrt(cos theta) and a trapezoid sum in phi.
std::vector<double> byQuadrature(const Basis& basis, const Basis& harmonics, Quantity quantity) {
    using Rule = boost::math::quadrature::gauss<double, 60>;
    const auto rows = static_cast<std::size_t>(basis.slots());
    const auto columns = static_cast<std::size_t>(harmonics.slots());
    std::vector<double> sums(rows * columns, 0.0), b(rows), y(columns);
    const int azimuths = 2 * (basis.order() + harmonics.order());
    for (std::size_t i = 0; i < 60; ++i) {
        const double node = Rule::abscissa()[i / 2] * (i % 2 == 0 ? 1 : -1);
        const double u = 0.5 * (1 + node), mu = u * u, sine = std::sqrt((1 - mu) * (1 + mu));
        const double weight = Rule::weights()[i / 2] * u * (quantity == Quantity::brdf ? mu : 1);
        for (int k = 0; k < azimuths; ++k) {
            const double phi = 2 * pi * (k + 0.3) / azimuths;
            const Direction d{sine * std::cos(phi), sine * std::sin(phi), mu};
            basis.evaluate(d, b.data());
            harmonics.evaluate(d, y.data());
            for (std::size_t r = 0; r < rows; ++r)
                for (std::size_t c = 0; c < columns; ++c)
                    sums[r * columns + c] += weight * 2 * pi / azimuths * b[r] * y[c];
        }
    }
    return sums;
}

TEST(EnvironmentMatrix, AgreesWithQuadratureInBothAngles) {
    for (const bases::Entry& entry : bases::catalog()) {
        const BasisOptions options{.condonShortley = true};
        const auto basis = entry.make(std::min(9, entry.maxOrder), options);
        const auto harmonics = bases::makeSh(6, options);
        for (const Quantity quantity : {Quantity::brdf, Quantity::brdfCosine}) {
            const std::vector<double> expected = byQuadrature(*basis, *harmonics, quantity);
            std::vector<double> found(expected.size(), 0.0);
            for (const auto& e : environmentMatrix(*basis, 6, quantity))
                found[static_cast<std::size_t>(e.slot * 36 + e.environment)] = e.value;
            for (std::size_t i = 0; i < found.size(); ++i)
                EXPECT_NEAR(found[i], expected[i], 2e-9) << entry.name << " " << i;
        }
    }
}

/// A constant light L has the one coefficient L sqrt(4 pi); a Lambert BRDF kd / pi sends back kd L.
/// For bases that contain 1, it is their function (0, 0) alone.
TEST(EnvironmentMatrix, LambertUnderAConstantLight) {
    const double kd = 0.7, light = 3;
    for (const char* name : {"hsh", "sh", "lsosh", "zernike", "h-basis"}) {
        const auto basis = bases::make(name, 3, {});
        std::vector<double> at(9);
        basis->evaluate({0, 0, 1}, at.data());
        const double coefficient = kd / pi / at[0];
        double reflected = 0;
        for (const auto& e : environmentMatrix(*basis, 4, Quantity::brdf)) {
            if (e.slot == 0 && e.environment == 0)
                reflected += coefficient * e.value * light * std::sqrt(4 * pi);
        }
        EXPECT_NEAR(reflected, kd * light, 1e-9) << name;
    }
}

TEST(EnvironmentMatrix, HighOrdersAgreeWithBoost) {
    // HSH against SH with f cos: a product of two Legendre polynomials at m = 0.
    const auto basis = bases::make("hsh", 18, {});
    const auto elements = environmentMatrix(*basis, 16, Quantity::brdfCosine);
    for (const auto& [l, j] : {std::pair{17, 15}, {17, 0}, {0, 15}, {9, 14}}) {
        const auto product = [l, j](double mu) {
            return std::sqrt(2.0 * l + 1) * boost::math::legendre_p(l, 2 * mu - 1) *
                   std::sqrt(j + 0.5) * boost::math::legendre_p(j, mu);
        };
        const double expected =
            boost::math::quadrature::gauss_kronrod<double, 61>::integrate(product, 0.0, 1.0, 5);
        double found = 0;
        for (const auto& e : elements)
            if (e.slot == slotOf(l, 0) && e.environment == slotOf(j, 0)) found = e.value;
        EXPECT_NEAR(found, expected, 1e-9) << l << " " << j;
    }
}

TEST(EnvironmentMatrix, OrthonormalBasesGiveTheirOwnProducts) {
    // SH of the whole sphere are half orthonormal on a hemisphere where l + l' is even.
    const auto basis = bases::make("sh", 6, {});
    for (const auto& e : environmentMatrix(*basis, 6, Quantity::brdfCosine)) {
        const int l = static_cast<int>(std::sqrt(e.slot)),
                  j = static_cast<int>(std::sqrt(e.environment));
        if ((l + j) % 2 == 0) {
            EXPECT_EQ(e.slot, e.environment);
            EXPECT_NEAR(e.value, 0.5, 1e-12);
        }
    }
}

}  // namespace
}  // namespace hshfit::gpu
