#include <hshfit/bases/catalog.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "reference.h"

namespace hshfit {
namespace {

constexpr double halfPi = pi / 2;

class BasisPrecision : public testing::TestWithParam<const bases::Entry*> {};

std::vector<const bases::Entry*> entries(int order) {
    std::vector<const bases::Entry*> rows;
    for (const bases::Entry& entry : bases::catalog())
        if (entry.maxOrder >= order) rows.push_back(&entry);
    return rows;
}

std::string parameterName(const testing::TestParamInfo<const bases::Entry*>& row) {
    std::string name(row.param->name);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// Largest |T_l^m| over the hemisphere, at least the root mean square over it: 1, or sqrt(1/2) for
/// functions that are normalised on the sphere. A lower bound keeps the test on the safe side.
constexpr double largestAtLeast = 0.7;

class BasisPrecisionAt1000 : public BasisPrecision {};

TEST_P(BasisPrecisionAt1000, AgainstExplicitSums) {
    const bases::Entry& entry = *GetParam();
    const auto basis = entry.make(1000, {});
    const auto slots = static_cast<std::size_t>(basis->slots());
    const std::pair<int, int> functions[] = {
        {999, 0},   {998, 0},   {999, 1},   {998, -2},  {999, -11}, {998, 100}, {999, -501},
        {998, 900}, {999, 997}, {999, 999}, {500, 250}, {751, -3},  {400, 399}, {800, 800},
    };
    std::vector<double> values(slots);
    std::vector<float> singles(slots);
    for (const double theta :
         {1e-8, 1e-5, 1e-3, 0.03, 0.3, radians(45), 1.2, 1.5, radians(89.99), halfPi - 1e-8}) {
        const double phi = 0.7;
        const Direction d = directionFromAngles(theta, phi);
        const DirectionBatch one{&d.x, &d.y, &d.z, 1};
        basis->evaluate(one, values.data());
        basis->evaluate(one, singles.data());
        for (const auto& [l, m] : functions) {
            if (!basis->has(l, m)) continue;
            SCOPED_TRACE(testing::Message() << l << " " << m << " at " << theta);
            const double value = values[slotOf(l, m)];
            const auto fromVector =
                reference::value(entry.name, l, m, reference::fromVector(d.x, d.y, d.z));
            const auto fromAngles = reference::value(entry.name, l, m, {theta, phi});
            // makhotkin-flux alone grows large, as sqrt(2) l^{3/2} at the horizon.
            const double largest =
                std::max(largestAtLeast, std::abs(static_cast<double>(fromVector)));
            EXPECT_LE(abs(fromVector - value), 1e-10 * largest);
            EXPECT_LE(abs(fromAngles - value), 1e-10 * largest);
            EXPECT_LE(abs(fromVector - singles[slotOf(l, m)]), 1e-3 * largest);
            // A zero has to be the truth: below the range, or at a zero of the function.
            EXPECT_TRUE(value != 0 || abs(fromVector) < 1e-300);
            EXPECT_TRUE(value == 0 || std::abs(value) >= std::numeric_limits<double>::min());
        }
    }
}

// No zeros in 0 < theta < 90 deg for l = m: what counts there is the relative error, to the very
// end of the range of the number type.
TEST_P(BasisPrecisionAt1000, SectoralFunctionsKeepTheirDigitsDownToUnderflow) {
    const bases::Entry& entry = *GetParam();
    const auto basis = entry.make(1000, {});
    int seen = 0, underflown = 0;
    for (const int m : {1, 10, 137, 400, 999}) {
        for (const double theta : {1e-12, 1e-6, 1e-2, 0.3, 0.6, 1.1, halfPi - 1e-3}) {
            const Elevation<double> e = elevationOf(directionFromAngles(theta, 0));
            const Elevation<float> single{static_cast<float>(e.mu),
                                          static_cast<float>(e.oneMinusMu)};
            std::vector<double> parts(static_cast<std::size_t>(1000 - m));
            std::vector<float> singles(parts.size());
            basis->theta(m, {&e, 1}, parts.data());
            basis->theta(m, {&single, 1}, singles.data());
            const auto truth = reference::thetaPart(entry.name, m, m, theta);
            SCOPED_TRACE(testing::Message() << m << " at " << theta);
            if (truth > 1.001 * std::numeric_limits<double>::min()) {
                ++seen;
                EXPECT_LE(abs(parts[0] / truth - 1), 1e-12);
            } else {
                ++underflown;
                EXPECT_EQ(parts[0], 0);
            }
            // Rounding mu or 1 - mu to float alone changes the m-th power by m 2^-24.
            if (truth > 1.001 * std::numeric_limits<float>::min())
                EXPECT_LE(abs(singles[0] / truth - 1), (m + 4) * 1.2e-7);
            else
                EXPECT_EQ(singles[0], 0);
        }
    }
    EXPECT_GT(seen, 10);
    EXPECT_GT(underflown, 2);
}

// Columns that start below the range of the number type come back into it with all digits. In
// double this concerns tiny values only: (m/l)^m, where a column wakes up, is above 1e-160.
TEST_P(BasisPrecisionAt1000, ColumnsComeBackFromUnderflow) {
    const bases::Entry& entry = *GetParam();
    const auto basis = entry.make(1000, {});
    const int m = 400, l = 998;
    int tiny = 0, returned = 0;
    for (const double theta : {0.1, 0.15, 0.2, 0.3, 0.35, 0.42, 0.45, 0.5, 0.6, 0.65}) {
        const Elevation<double> e = elevationOf(directionFromAngles(theta, 0));
        const Elevation<float> single{static_cast<float>(e.mu), static_cast<float>(e.oneMinusMu)};
        std::vector<double> parts(600);
        std::vector<float> singles(600);
        basis->theta(m, {&e, 1}, parts.data());
        basis->theta(m, {&single, 1}, singles.data());
        const auto truth = static_cast<double>(reference::thetaPart(entry.name, l, m, theta));
        EXPECT_NEAR(parts[l - m], truth, 1e-11);
        EXPECT_NEAR(singles[l - m], truth, 1e-3);
        if (parts[0] == 0 && std::abs(truth) > 1e-300) {
            ++tiny;
            EXPECT_NEAR(parts[l - m] / truth, 1, 1e-10);
        }
        returned += singles[0] == 0 && std::abs(truth) > 0.1;
    }
    EXPECT_GT(tiny, 0);
    EXPECT_GT(returned, 0);
}

INSTANTIATE_TEST_SUITE_P(Catalog, BasisPrecisionAt1000, testing::ValuesIn(entries(1000)),
                         parameterName);

/// Nothing but finite numbers, and no column that has died: at least one function with each m is
/// far from 0 somewhere among the directions.
template <class Real>
void expectAlive(const bases::Entry& entry, int order) {
    const auto basis = entry.make(order, {});
    const auto slots = static_cast<std::size_t>(basis->slots());
    std::vector<Real> values(slots);
    std::vector<double> largest(slots, 0.0);
    for (const double theta : {0.0, 1e-12, 0.01, radians(20), radians(45), radians(60), radians(75),
                               radians(85), radians(89.99), halfPi}) {
        const Direction d = directionFromAngles(theta, 0.3);
        const DirectionBatch one{&d.x, &d.y, &d.z, 1};
        basis->evaluate(one, values.data());
        for (std::size_t i = 0; i < slots; ++i) {
            ASSERT_TRUE(std::isfinite(values[i])) << entry.name << " slot " << i << " " << theta;
            largest[i] = std::max(largest[i], std::abs(static_cast<double>(values[i])));
        }
    }
    const Direction horizon{1, 0, 0};
    basis->evaluate(DirectionBatch{&horizon.x, &horizon.y, &horizon.z, 1}, values.data());
    for (const Real value : values) ASSERT_TRUE(std::isfinite(value)) << entry.name;
    for (int m = 1 - order; m < order; ++m) {
        double column = 0;
        for (int l = std::abs(m); l < order; ++l)
            if (basis->has(l, m)) column = std::max(column, largest[slotOf(l, m)]);
        EXPECT_TRUE(column > 1e-4 || !basis->has(std::abs(m), m)) << entry.name << " m " << m;
    }
}

TEST_P(BasisPrecision, IsFiniteAndDoesNotVanishInDouble) {
    for (const int order : {1, 2, 3, 7, 100, 1000})
        if (order <= GetParam()->maxOrder) expectAlive<double>(*GetParam(), order);
}

TEST_P(BasisPrecision, IsFiniteAndDoesNotVanishInFloat) {
    for (const int order : {1, 2, 3, 7, 100, 1000})
        if (order <= GetParam()->maxOrder) expectAlive<float>(*GetParam(), order);
}

// At the pole only m = 0 is left, and the value is known: sqrt(2l+1) P_l(1) and the like.
TEST(BasisPrecisionAtTheEnds, ValuesAtPoleAndHorizonAreTheClosedForms) {
    const Elevation<double> pole{1, 0}, horizon{0, 1};
    const auto at = [](std::string_view name, const Elevation<double>& e) {
        std::vector<double> parts(1000);
        bases::make(name, 1000)->theta(0, {&e, 1}, parts.data());
        return parts;
    };
    const auto hshPole = at("hsh", pole), hshHorizon = at("hsh", horizon), shPole = at("sh", pole);
    const auto fluxPole = at("makhotkin-flux", pole), flux = at("makhotkin-flux", horizon);
    const auto zernikePole = at("zernike", pole), zernike = at("zernike", horizon);
    for (int l = 0; l < 1000; ++l) {
        const double root = std::sqrt(2 * l + 1.0), sign = l % 2 ? -1 : 1;
        const auto expectRelative = [l](double value, double expected) {
            EXPECT_NEAR(value, expected, 2e-14 * std::abs(expected)) << l;
        };
        expectRelative(hshPole[l], root);
        expectRelative(hshHorizon[l], sign * root);
        expectRelative(shPole[l], root / std::sqrt(2));
        expectRelative(fluxPole[l], std::sqrt(2 * l + 2.0));  // P_l^{(0,1)}(1) = 1
        expectRelative(flux[l], sign * std::sqrt(2 * l + 2.0) * (l + 1));
        if (l % 2 == 0) {
            expectRelative(zernikePole[l], std::sqrt(l + 1.0) * (l % 4 ? -1 : 1));
            expectRelative(zernike[l], std::sqrt(l + 1.0));  // R_q^m(1) = 1
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Catalog, BasisPrecision, testing::ValuesIn(entries(1)), parameterName);

}  // namespace
}  // namespace hshfit
