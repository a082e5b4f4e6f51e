#include "lib/bases/reference.h"
#include "lib/formula_brdf.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/bases/jacobi.h>
#include <hshfit/stability/internal/basis_change_errors.h>
#include <hshfit/stability/internal/reference.h>
#include <hshfit/stability/internal/rotation_errors.h>
#include <hshfit/stability/stress.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <memory>

namespace hshfit::stability {
namespace {

std::vector<const bases::Entry*> jacobiEntries() {
    std::vector<const bases::Entry*> rows;
    for (const bases::Entry& entry : bases::catalog()) {
        const auto basis = entry.make(2, {});
        if (dynamic_cast<const bases::JacobiBasis*>(basis.get())) rows.push_back(&entry);
    }
    return rows;
}

const bases::JacobiBasis& asJacobi(const Basis& basis) {
    return dynamic_cast<const bases::JacobiBasis&>(basis);
}

TEST(StabilityReference, IsRightToTheAccuracyThatItClaims) {
    // The difference between the reference and explicit sums in 1200 digits, at the vectors as they
    // are.
    ASSERT_GE(jacobiEntries().size(), 6U);
    for (const bases::Entry* entry : jacobiEntries()) {
        const auto basis = entry->make(1000, {});
        for (double theta : {1e-8, 1e-3, 0.3, radians(45), 1.2, radians(89.99), pi / 2 - 1e-8}) {
            const Direction d{std::sin(theta), 0, std::cos(theta)};
            const reference::Place place{
                d.z < 0.7 ? acos(reference::Real(d.z)) : asin(reference::Real(d.x)), 0};
            for (int m : {0, 1, 2, 11, 100, 501, 900, 998}) {
                const auto values = referenceTheta(asJacobi(*basis).family(), m, 1000, {d});
                for (int l : {m, m + 1, 500, 751, 998, 999}) {
                    if (l < m || l > 999 || !basis->has(l, m)) continue;
                    const double expected =
                        static_cast<double>(reference::thetaPart(entry->name, l, m, place.theta));
                    EXPECT_NEAR(static_cast<double>(values[static_cast<std::size_t>(l - m)]),
                                expected, 3e-14 * std::max(1.0, std::abs(expected)))
                        << entry->name << " " << l << " " << m << " at " << theta;
                }
            }
        }
    }
}

TEST(StabilityErrors, AreOfTheSizeOfRounding) {
    for (const bases::Entry* entry : jacobiEntries()) {
        const auto basis = entry->make(65, {});
        for (const auto& errors : {evaluationErrors(asJacobi(*basis), Precision::twice),
                                   orthonormalityErrors(asJacobi(*basis), Precision::twice)}) {
            EXPECT_EQ(errors.goodUntil(1e-12), 64) << entry->name;
            EXPECT_LT(errors.goodUntil(1e-16), 6) << entry->name;
        }
        // Rounding to float alone is 3e-8 to 6e-8.
        for (const auto& errors : {evaluationErrors(asJacobi(*basis), Precision::single),
                                   orthonormalityErrors(asJacobi(*basis), Precision::single)}) {
            EXPECT_EQ(errors.goodUntil(1e-3), 64) << entry->name;
            EXPECT_LT(errors.goodUntil(1e-8), 2) << entry->name;
        }
    }
}

TEST(StabilityErrors, GoodUntilEndsBeforeTheFirstErrorAboveTheBound) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const DegreeErrors errors{"x", Precision::twice, {1e-16, none, 1e-9, 1e-4, 1e-16}};
    EXPECT_EQ(errors.goodUntil(1e-3), 4);
    EXPECT_EQ(errors.goodUntil(1e-6), 2);
    EXPECT_EQ(errors.goodUntil(1e-12), 1);
    EXPECT_EQ(errors.goodUntil(1e-17), -1);
}

TEST(StabilityErrors, SampledOrdersHoldTheEnds) {
    for (int order : {1, 2, 3, 64, 1000}) {
        const auto sampled = sampledOrders(order);
        EXPECT_EQ(sampled.front(), 0);
        EXPECT_EQ(sampled.back(), order - 1);
        EXPECT_TRUE(std::is_sorted(sampled.begin(), sampled.end()));
    }
}

TEST(StabilityRotation, RoundingGrowsWithTheDegreeAndStaysBelowTheBoundsOfTheRoom) {
    const DegreeErrors errors = rotationErrors(300);
    ASSERT_EQ(errors.error.size(), 300U);
    EXPECT_EQ(errors.goodUntil(1e-12), 299);
    EXPECT_GE(errors.goodUntil(1e-13), 99);
    EXPECT_LT(errors.goodUntil(1e-16), 10);
}

TEST(StabilityRotation, FloatKeepsTheDigitsOfFloat) {
    const DegreeErrors errors = rotationErrors(130, Precision::single);
    ASSERT_EQ(errors.error.size(), 130U);
    EXPECT_EQ(errors.goodUntil(1e-5), 129);
    EXPECT_LT(errors.goodUntil(1e-8), 2);
    EXPECT_TRUE(std::isnan(errors.error[50]));  // degrees in between are not measured
    EXPECT_FALSE(std::isnan(errors.error[129]));
}

TEST(StabilityRotation, MatricesOfInverseRotationsOnTheHemisphereAreTransposed) {
    for (const char* name : {"hsh", "makhotkin"}) {
        const auto basis = bases::make(name, 7);
        const DegreeErrors twice = hemisphereRotationErrors(*basis, Precision::twice);
        EXPECT_EQ(twice.goodUntil(1e-11), 6) << name;
        EXPECT_LT(twice.goodUntil(1e-17), 6) << name;
        const DegreeErrors single = hemisphereRotationErrors(*basis, Precision::single);
        EXPECT_EQ(single.goodUntil(1e-5), 6) << name;
        EXPECT_LT(single.goodUntil(1e-9), 6) << name;
    }
}

TEST(StabilityChange, AgreesWithExtendedPrecision) {
    const auto sh = bases::make("sh", 65);
    for (const char* name : {"hsh", "esh", "zernike", "makhotkin", "makhotkin-flux"}) {
        const auto basis = bases::make(name, 65);
        const DegreeErrors twice =
            basisChangeErrors(asJacobi(*sh), asJacobi(*basis), Precision::twice);
        EXPECT_EQ(twice.basis, std::string("sh to ") + name);
        EXPECT_EQ(twice.goodUntil(1e-13), 64) << name;
        EXPECT_LT(twice.goodUntil(1e-18), 64) << name;
        EXPECT_EQ(
            basisChangeErrors(asJacobi(*sh), asJacobi(*basis), Precision::single).goodUntil(1e-6),
            64)
            << name;
    }
}

TEST(StabilityGram, ConditionOfTheSmallestIsItsClosedForm) {
    // m = 0 at order 2: [[1/2, sqrt(3)/4], [sqrt(3)/4, 1/2]], with eigenvalues (2 +- sqrt(3))/4.
    const bases::LsoshGram gram = bases::lsoshGram(2);
    EXPECT_NEAR(gram.condition, std::pow(2 + std::sqrt(3.0), 2), 1e-12);
    EXPECT_EQ(gram.kept, 4);
    double before = 0;
    for (int order = 2; order <= 12; ++order) {
        const double condition = bases::lsoshGram(order).condition;
        EXPECT_GT(condition, 3 * before) << order;
        before = condition;
    }
    EXPECT_LT(bases::lsoshGram(40).kept, 1600);
}

TEST(Stress, LobesThatDoNotProjectSayWhy) {
    const test::FormulaBrdf steep(
        [](const Direction& wi, const Direction&) { return 1 / (wi.z * wi.z * wi.z); });
    const test::FormulaBrdf flat([](const Direction&, const Direction&) { return 0.3; });
    const Brdf* const lobes[] = {&flat, &steep};
    const StressReport report = stress({}, lobes, {.maxOrder = 4, .thetaDegrees = {0, 89.99}});
    ASSERT_EQ(report.projection.size(), 4U);
    for (std::size_t k : {0U, 1U}) {
        EXPECT_TRUE(report.projection[k].converged) << report.projection[k].reason;
        EXPECT_LE(report.projection[k].error, 1e-6);
    }
    for (std::size_t k : {2U, 3U}) {
        EXPECT_FALSE(report.projection[k].converged);
        EXPECT_NE(report.projection[k].reason.find("cos(theta_i)"), std::string::npos);
    }
}

TEST(Stress, SameReportWhateverTheThreads) {
    const auto rows = bases::select("hsh,lsosh");
    const test::FormulaBrdf flat([](const Direction&, const Direction&) { return 0.3; });
    const Brdf* const lobes[] = {&flat};
    const auto json = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        return stressJson(stress(rows, lobes, {.maxOrder = 33}));
    };
    EXPECT_EQ(json(1), json(2));
}

}  // namespace
}  // namespace hshfit::stability
