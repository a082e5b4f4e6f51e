// The vector kernels on every instruction set of this machine: against the scalar path, against
// recurrences in 100 digits, and bit for bit against themselves in batches of other sizes.

#include <hshfit/vector_targets.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/bases/jacobi.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "columns_reference.h"

namespace hshfit {
namespace {

using bases::JacobiBasis;

const char* const families[] = {"hsh", "sh", "esh", "zernike", "makhotkin", "makhotkin-flux"};

/// Runs `check` once for each instruction set that was compiled and that this machine has.
template <class Check>
void forEachTarget(Check check) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        SCOPED_TRACE(hwy::TargetName(target));
        hwy::SetSupportedTargetsForTest(target);
        check();
        hwy::SetSupportedTargetsForTest(0);
        if (testing::Test::HasFatalFailure()) return;
    }
}

struct Directions {
    std::vector<double> x, y, z;

    void add(const Direction& d) { x.push_back(d.x), y.push_back(d.y), z.push_back(d.z); }
    DirectionBatch batch(std::size_t first, std::size_t count) const {
        return {x.data() + first, y.data() + first, z.data() + first, count};
    }
    DirectionBatch batch() const { return batch(0, x.size()); }
};

/// Pole, horizon, both sides of it, denormal and vanishing components, and `more` at random.
Directions extremes(std::size_t more, bool belowToo = true) {
    Directions all;
    const double tiny = std::numeric_limits<double>::denorm_min();
    for (const Direction& d : {Direction{0, 0, 1},
                               {1, 0, 0},
                               {0, -1, 0},
                               {-1, 0, 0},
                               {1e-300, 0, 1},
                               {tiny, -tiny, 1},
                               {1e-160, 2e-160, 1},
                               {1, 0, tiny},
                               {0.6, 0.8, 1e-300},
                               {0.6, -0.8, 1e-9},
                               {-1, 1e-300, 0},
                               {0, 1e-20, 1},
                               {1, tiny, 1e-320}})
        all.add(d);
    for (const double small : {1e-12, 1e-8, 1e-4, 1e-2}) {
        all.add(directionFromAngles(small, 2.5));
        all.add(directionFromAngles(pi / 2 - small, -0.6));
    }
    if (belowToo)
        for (const Direction& d : {Direction{0, 0, -1}, {0.6, 0.8, -1e-30}, {0.6, 0, -0.8}})
            all.add(d);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform;
    for (std::size_t k = 0; k < more; ++k)
        all.add(directionFromAngles(std::acos(uniform(random)), 2 * pi * uniform(random)));
    return all;
}

/// [slot]: the largest magnitude that the scalar path finds among many elevations; what errors are
/// relative to. A lower bound of the true maximum, so that no error looks smaller than it is.
std::vector<double> largestValues(const JacobiBasis& basis) {
    std::vector<double> largest(static_cast<std::size_t>(basis.slots()), 0.0);
    std::vector<Elevation<double>> points{{1, 0}, {0, 1}};
    for (int k = 1; k < 4 * basis.order() + 60; ++k)
        points.push_back(
            elevationOf(directionFromAngles(pi / 2 * k / (4 * basis.order() + 60), 0)));
    std::vector<double> parts(points.size() * static_cast<std::size_t>(basis.order()));
    for (int m = 0; m < basis.order(); ++m) {
        basis.thetaScalar(m, points, parts.data());
        for (int l = m; l < basis.order(); ++l) {
            double most = 0;
            for (std::size_t k = 0; k < points.size(); ++k)
                most = std::max(
                    most, std::abs(parts[static_cast<std::size_t>(l - m) * points.size() + k]));
            largest[slotOf(l, m)] = largest[slotOf(l, -m)] = most / std::sqrt(m ? pi : 2 * pi);
        }
    }
    return largest;
}

template <class Real>
std::vector<Real> byDirection(const Basis& basis, DirectionBatch directions) {
    std::vector<Real> out(directions.count * static_cast<std::size_t>(basis.slots()));
    basis.evaluate(directions, out.data());
    return out;
}

const JacobiBasis& jacobi(const Basis& basis) {
    return dynamic_cast<const JacobiBasis&>(basis);
}

/// Twice what one path may err by: both round.
double tolerance(int order, bool single) {
    if (single) return 2.5e-7 * std::max(order, 4);
    return order <= 65 ? 6e-14 : order <= 301 ? 1e-12 : 4e-12;
}

template <class Real>
void expectScalarValues(const char* name, int order, std::size_t more) {
    for (const bool condonShortley : {false, true}) {
        const auto basis = bases::make(name, order, {.condonShortley = condonShortley});
        const auto reference = scalarReference(jacobi(*basis));
        const std::vector<double> largest = largestValues(jacobi(*basis));
        const Directions directions = extremes(more);
        const auto slots = static_cast<std::size_t>(basis->slots());
        const auto values = byDirection<Real>(*basis, directions.batch());
        const auto expected = byDirection<double>(*reference, directions.batch());
        std::vector<Real> columns(values.size());
        basis->evaluateColumns(directions.batch(), columns.data());
        double worst = 0;
        for (std::size_t k = 0; k < directions.x.size(); ++k)
            for (std::size_t i = 0; i < slots; ++i) {
                const double value = values[k * slots + i];
                ASSERT_TRUE(std::isfinite(value)) << name << " direction " << k << " slot " << i;
                ASSERT_EQ(columns[i * directions.x.size() + k], values[k * slots + i]);
                const double error = std::abs(value - expected[k * slots + i]);
                if (largest[i] == 0)
                    ASSERT_EQ(value, 0);
                else
                    worst = std::max(worst, error / largest[i]);
            }
        EXPECT_LE(worst, tolerance(order, sizeof(Real) == sizeof(float))) << name << " " << order;
    }
}

TEST(BasisKernels, BatchesHaveTheScalarValues) {
    forEachTarget([] {
        for (const char* name : families)
            for (const int order : {1, 2, 3, 7, 10, 11, 12, 33, 65}) {
                expectScalarValues<double>(name, order, order > 32 ? 10 : 60);
                expectScalarValues<float>(name, order, order > 32 ? 10 : 60);
            }
    });
}

template <class Real>
void expectScalarTheta(const JacobiBasis& basis, int m, const std::vector<double>& largest) {
    std::vector<Elevation<Real>> points;
    const Directions directions = extremes(40);
    for (std::size_t k = 0; k < directions.x.size(); ++k) {
        const Elevation<double> e =
            elevationOf({directions.x[k], directions.y[k], directions.z[k]});
        points.push_back({static_cast<Real>(e.mu), static_cast<Real>(e.oneMinusMu)});
    }
    const std::size_t rows = static_cast<std::size_t>(basis.order() - m);
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, std::size_t{5}, points.size()}) {
        std::vector<Real> values(rows * count), expected(rows * count);
        basis.theta(m, std::span(points).first(count), values.data());
        basis.thetaScalar(m, std::span(points).first(count), expected.data());
        for (std::size_t i = 0; i < values.size(); ++i) {
            const int l = m + static_cast<int>(i / count);
            const double scale = largest[slotOf(l, m)] * std::sqrt(2 * pi);
            ASSERT_NEAR(values[i], expected[i],
                        tolerance(basis.order(), sizeof(Real) == sizeof(float)) * scale)
                << basis.name() << " " << l << " " << m << " point " << i % count;
            ASSERT_TRUE(values[i] == 0 || std::abs(values[i]) >= std::numeric_limits<Real>::min());
        }
    }
}

TEST(BasisKernels, ThetaPartsAreThoseOfTheScalarPath) {
    forEachTarget([] {
        for (const char* name : families)
            for (const int order : {1, 2, 7, 20, 300}) {
                const auto basis = bases::make(name, order);
                const std::vector<double> largest = largestValues(jacobi(*basis));
                for (const int m : {0, 1, 2, 19, 150, 299}) {
                    if (m >= order) break;
                    expectScalarTheta<double>(jacobi(*basis), m, largest);
                    expectScalarTheta<float>(jacobi(*basis), m, largest);
                }
            }
    });
}

template <class Real>
void expectSameBits(const char* name, int order) {
    const auto basis = bases::make(name, order);
    const auto slots = static_cast<std::size_t>(basis->slots());
    const Directions directions = extremes(order > 10 ? 300 : 4072);
    const std::size_t count = directions.x.size();
    const auto all = byDirection<Real>(*basis, directions.batch());
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{17}})
        for (std::size_t first = 0; first + size <= count && first < 100; first += size + 1) {
            std::vector<Real> some = byDirection<Real>(*basis, directions.batch(first, size));
            ASSERT_EQ(some.size(), size * slots);
            // An empty vector has no bytes to compare, and memcmp takes no null pointer.
            if (size > 0) {
                ASSERT_EQ(std::memcmp(some.data(), all.data() + first * slots,
                                      some.size() * sizeof(Real)),
                          0)
                    << name << " order " << order << ", " << size << " from " << first;
            }
            std::vector<Real> columns(size * slots);
            basis->evaluateColumns(directions.batch(first, size), columns.data());
            for (std::size_t k = 0; k < size; ++k)
                for (std::size_t i = 0; i < slots; ++i)
                    ASSERT_EQ(columns[i * size + k], all[(first + k) * slots + i]);
        }
}

TEST(BasisKernels, ADirectionHasTheSameBitsInEveryBatch) {
    forEachTarget([] {
        for (const char* name : families)
            for (const int order : {1, 2, 7, 10, 11, 34}) {
                expectSameBits<double>(name, order);
                expectSameBits<float>(name, order);
            }
    });
}

// sqrt(3 / 4 pi) y: near the lower pole the scalar path, which has mu and 1 - mu
// but not 1 + mu, loses the sine; batches take it from x and y.
TEST(BasisKernels, DigitsAreKeptAtTheLowerPole) {
    forEachTarget([] {
        for (const int order : {2, 10, 12}) {
            const Direction d{0, 1e-9, -1};
            std::vector<double> values(static_cast<std::size_t>(order * order));
            bases::make("sh", order)->evaluate(d, values.data());
            EXPECT_NEAR(values[slotOf(1, -1)] / (std::sqrt(3 / (4 * pi)) * d.y), 1, 1e-15);
        }
    });
}

TEST(BasisKernels, NothingIsWrittenBeyondTheBatch) {
    forEachTarget([] {
        for (const int order : {1, 2, 3, 5, 7, 10, 11, 15})
            for (std::size_t count = 0; count < 20; ++count) {
                const auto basis = bases::make("makhotkin", order);
                const Directions directions = extremes(20);
                const std::size_t values = count * static_cast<std::size_t>(basis->slots());
                std::vector<double> out(values + 64, -7.0);
                basis->evaluate(directions.batch(0, count), out.data());
                EXPECT_EQ(std::count(out.begin(), out.end(), -7.0), 64);
                std::fill(out.begin(), out.end(), -7.0);
                basis->evaluateColumns(directions.batch(0, count), out.data());
                EXPECT_EQ(std::count(out.begin(), out.end(), -7.0), 64);
            }
    });
}

/// Largest error over the maximum of a function, of the functions (l, m) of one degree and a few
/// below, at directions from angles and at the vectors themselves.
double worstError(const char* name, int degree, const std::vector<double>& angles) {
    const auto basis = bases::make(name, degree + 1);
    const JacobiBasis& tables = jacobi(*basis);
    std::vector<double> values(static_cast<std::size_t>(basis->slots()));
    std::map<int, std::vector<double>> largest;  // by m: over elevations, [l - m]
    const int columns[] = {0, 1, 2, degree / 7, degree / 3, degree - 2, degree};
    for (const int m : columns) {
        std::vector<Elevation<double>> points{{1, 0}, {0, 1}};
        for (int k = 1; k < 3 * degree; ++k)
            points.push_back(elevationOf(directionFromAngles(pi / 2 * k / (3.0 * degree), 0)));
        std::vector<double> parts(points.size() * static_cast<std::size_t>(degree + 1 - m));
        tables.thetaScalar(m, points, parts.data());
        for (std::size_t i = 0; i < parts.size(); i += points.size()) {
            double most = 0;
            for (std::size_t k = 0; k < points.size(); ++k)
                most = std::max(most, std::abs(parts[i + k]));
            largest[m].push_back(most / std::sqrt(m ? pi : 2 * pi));
        }
    }
    double worst = 0;
    for (const double theta : angles) {
        const double phi = 0.7;
        const Direction d = directionFromAngles(theta, phi);
        basis->evaluate(d, values.data());
        for (const int m : columns) {
            const auto fromAngles = columns::values(name, degree, m, {theta, phi});
            const auto fromVector = columns::values(name, degree, m, columns::place(d.x, d.y, d.z));
            for (int l = std::max(m, degree - 3); l <= degree; ++l) {
                if (!basis->has(l, m)) continue;
                const auto i = static_cast<std::size_t>(l - m);
                const double value = values[slotOf(l, m)];
                for (const auto& truth : {fromAngles[i], fromVector[i]})
                    worst = std::max(worst,
                                     std::abs(static_cast<double>(truth - value)) / largest[m][i]);
            }
        }
    }
    return worst;
}

class BasisKernelErrors : public testing::TestWithParam<const char*> {};

TEST_P(BasisKernelErrors, StayWithinTheStatedBounds) {
    const std::vector<double> angles{1e-8, 1e-3, 0.1, 0.5, 0.8, pi / 3, 1.3, 1.5, 1.57};
    forEachTarget([&] {
        for (const auto& [degree, bound] :
             {std::pair{2, 3e-14}, {6, 3e-14}, {9, 3e-14}, {10, 3e-14}, {64, 3e-14}, {300, 5e-13}})
            EXPECT_LE(worstError(GetParam(), degree, angles), bound) << "degree " << degree;
    });
    EXPECT_LE(worstError(GetParam(), 999, angles), 2e-12);
}

// The largest degree: nothing over- or underflows where a value is to be seen.
TEST_P(BasisKernelErrors, StayWithinTheStatedBoundsAtTheLargestDegree) {
    const int degree = bases::find(GetParam()).maxOrder - 1;
    EXPECT_EQ(degree, 2800);
    EXPECT_LE(worstError(GetParam(), degree, {1e-3, 0.7, 1.2, 1.57}), 6e-12);
    EXPECT_THROW(bases::make(GetParam(), degree + 2), std::exception);
}

INSTANTIATE_TEST_SUITE_P(Families, BasisKernelErrors, testing::ValuesIn(families),
                         [](const auto& row) {
                             std::string name(row.param);
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace hshfit
