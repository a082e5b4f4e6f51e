// Errors estimated from the changes of levels, for sequences whose limits are known.

#include <hshfit/projection/internal/convergence.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace hshfit {
namespace {

/// The error of the newest of `levels` levels, estimated from their changes.
PanelError estimate(const std::function<double(int)>& error, int levels, bool mayBeSmooth = true) {
    Changes changes;
    for (int k = 1; k < levels; ++k) changes.add(std::abs(error(k) - error(k - 1)));
    return panelError(changes, mayBeSmooth);
}

TEST(Convergence, NothingIsKnownOfOneLevel) {
    EXPECT_TRUE(std::isinf(panelError({}, true).expected));
    EXPECT_TRUE(std::isinf(panelError({}, false).stated));
}

TEST(Convergence, NoChangeIsNoError) {
    EXPECT_EQ(estimate([](int) { return 0.0; }, 2).stated, 0);
    EXPECT_EQ(estimate([](int) { return 0.0; }, 5).stated, 0);
}

/// Nodes grow by 1.4: errors exp(-rate 1.4^k) of Gauss-Legendre and trapezoid rules.
TEST(Convergence, ExponentialErrorsAreCovered) {
    for (const double rate : {2.0, 3.0, 4.0, 5.0}) {
        const auto error = [&](int k) { return std::exp(-rate * std::pow(1.4, k)); };
        for (int levels = 3; levels < 7; ++levels) {
            const double exact = error(levels - 1);
            const PanelError found = estimate(error, levels);
            EXPECT_GE(found.stated, exact) << rate << " " << levels;
            EXPECT_GE(found.stated, found.expected);
        }
    }
}

/// The last change alone is more than 400 times the error there.
TEST(Convergence, ExponentialErrorsAreNotTakenForChanges) {
    const auto error = [](int k) { return std::exp(-4 * std::pow(1.4, k)); };
    EXPECT_LE(estimate(error, 5).stated, 0.4 * error(3));
    // It is not believed for an interpolated table.
    EXPECT_GE(estimate(error, 5, false).stated, error(3) - error(4));
}

/// After one change the stated error is three times that change, which is about the error of the
/// level before.
TEST(Convergence, EarlyErrorsCoverExponentialOnesAndAccidents) {
    EXPECT_TRUE(std::isinf(earlyError({}).expected));
    for (const double rate : {2.0, 3.0, 4.0, 5.0}) {
        const auto error = [&](int k) { return std::exp(-rate * std::pow(1.4, k - 1)); };
        Changes changes;
        for (int k = 1; k < 3; ++k) {
            changes.add(std::abs(error(k) - error(k - 1)));
            const PanelError found = earlyError(changes);
            EXPECT_GE(found.stated, 2 * error(k)) << rate << " " << k;
            EXPECT_EQ(found.stated, found.expected);
        }
        // The second change alone is a tenth of the error, by accident.
        changes.values[0] = 0.1 * error(2);
        EXPECT_GE(1.2 * earlyError(changes).stated, error(2)) << rate;
    }
}

/// A last change that is a thousand times too small would hide nearly all of the error.
TEST(Convergence, AnAccidentOfTheLastChangeIsSeen) {
    for (const double rate : {2.0, 3.0, 4.0, 5.0}) {
        const auto error = [&](int k) { return std::exp(-rate * std::pow(1.4, k)); };
        for (int levels = 4; levels < 6; ++levels) {
            Changes changes;
            for (int k = 1; k < levels; ++k) {
                const double accident = k + 1 == levels ? 1e-3 : 1;
                changes.add(accident * std::abs(error(k) - error(k - 1)));
            }
            EXPECT_GE(10 * panelError(changes, true).stated, error(levels - 1))
                << rate << " " << levels;
        }
    }
}

/// Errors of one sign, as at a singularity that rules come nearer to: N^-1 is 1.4^-1 a level.
TEST(Convergence, SlowErrorsOfOneSignAreCovered) {
    for (const double ratio : {0.3, 0.5, 0.6, 0.7, 0.75}) {
        const auto error = [&](int k) { return std::pow(ratio, k); };
        for (int levels = 3; levels < 9; ++levels) {
            EXPECT_GE(estimate(error, levels).stated, 0.999 * error(levels - 1)) << ratio;
            EXPECT_LE(estimate(error, levels).stated, 20 * error(levels - 1)) << ratio;
        }
    }
}

/// Errors of both signs: every phase of a kink between nodes, over all of which few are not
/// covered. The last change alone misses a third of them.
TEST(Convergence, AccidentsOfKinksAreCovered) {
    constexpr double ratio = 0.43;
    int trials = 0, missed = 0, missedByLast = 0;
    for (int a = 0; a < 40; ++a) {
        for (int b = 1; b < 40; ++b) {
            const auto error = [&](int k) {
                return std::pow(ratio, k) * std::cos(0.1571 * a + 0.1571 * b * k);
            };
            const double exact = std::abs(error(5));
            missed += estimate(error, 6, false).stated < exact;
            missedByLast += std::abs(error(5) - error(4)) < exact;
            ++trials;
        }
    }
    EXPECT_LE(missed, trials / 100);
    EXPECT_GE(missedByLast, trials / 20);
}

/// One change of a table may be an accident, and refinement does not wait for a second one.
TEST(Convergence, OneChangeOfATableIsCoveredInEveryPhaseOfAKink) {
    constexpr double ratio = 0.43;
    int trials = 0, missed = 0, missedByOfTables = 0;
    for (int a = 0; a < 40; ++a) {
        for (int b = 1; b < 40; ++b) {
            const auto error = [&](int k) {
                return std::pow(ratio, k) * std::cos(0.1571 * a + 0.1571 * b * k);
            };
            const PanelError found = estimate(error, 2, false);
            EXPECT_EQ(found.expected, std::abs(error(1) - error(0)));
            missed += found.stated < std::abs(error(1));
            missedByOfTables += 3 * found.expected < std::abs(error(1));
            ++trials;
        }
    }
    EXPECT_LE(missed, trials / 50);
    EXPECT_GE(missedByOfTables, 2 * missed);
}

/// Refinement goes by the last change, which is less than what changes that go down slowly leave.
TEST(Convergence, OfATableTheLastChangeIsHeldToTheToleranceAndTheRestIsStated) {
    const auto error = [](int k) { return std::pow(0.7, k); };
    for (int levels = 3; levels < 9; ++levels) {
        const PanelError found = estimate(error, levels, false);
        EXPECT_DOUBLE_EQ(found.expected, std::abs(error(levels - 1) - error(levels - 2)));
        EXPECT_GE(found.stated, error(levels - 1));
        EXPECT_GT(found.stated, estimate(error, levels).stated);
    }
}

}  // namespace
}  // namespace hshfit
