// Vector code of bases and rotations on every instruction set, with directions and results that end
// where memory does: batches of every rest that vectors of up to 16 values leave.

#include <guarded_array.h>
#include <vector_targets.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/rotation/internal/quarter_turns.h>
#include <hshfit/rotation/sh_rotation.h>

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace hshfit {
namespace {

using test::forEveryTarget;
using test::GuardedArray;
using test::Side;

constexpr Side sides[] = {Side::front, Side::back};
const char* const families[] = {"hsh", "sh", "esh", "zernike", "makhotkin", "makhotkin-flux"};

Direction directionAt(std::size_t k) {
    const auto turn = static_cast<double>(k);
    return directionFromAngles(std::fmod(0.1 + 0.37 * turn, 1.5), 0.9 * turn);
}

/// Rows, columns and single directions agree, which kernels_test holds against recurrences.
template <class Real>
void checkBasis(const bases::Basis& basis, std::size_t count, Side side) {
    SCOPED_TRACE(fmt::format("{} {}, {} directions", basis.name(), basis.order(), count));
    const auto slots = static_cast<std::size_t>(basis.slots());
    const GuardedArray<double> x(count, side, [](std::size_t k) { return directionAt(k).x; });
    const GuardedArray<double> y(count, side, [](std::size_t k) { return directionAt(k).y; });
    const GuardedArray<double> z(count, side, [](std::size_t k) { return directionAt(k).z; });
    GuardedArray<Real> rows(count * slots, side), columns(count * slots, side), one(slots, side);
    basis.evaluate({x.data(), y.data(), z.data(), count}, rows.data());
    basis.evaluateColumns({x.data(), y.data(), z.data(), count}, columns.data());
    const std::size_t last = count - 1;
    basis.evaluate({x.data() + last, y.data() + last, z.data() + last, 1}, one.data());
    for (std::size_t i = 0; i < slots; ++i) {
        ASSERT_EQ(rows[last * slots + i], one[i]) << "slot " << i;
        for (std::size_t k = 0; k < count; ++k)
            ASSERT_EQ(rows[k * slots + i], columns[i * count + k]) << "slot " << i << ", " << k;
    }
}

template <class Real>
void checkTheta(const bases::Basis& basis, std::size_t count, Side side) {
    SCOPED_TRACE(fmt::format("{} {}, {} elevations", basis.name(), basis.order(), count));
    GuardedArray<Elevation<Real>> points(count, side);
    for (std::size_t k = 0; k < count; ++k) {
        const Elevation<double> at = elevationOf(directionAt(k));
        points[k] = {static_cast<Real>(at.mu), static_cast<Real>(at.oneMinusMu)};
    }
    for (int m = 0; m < basis.order(); ++m) {
        const auto rows = static_cast<std::size_t>(basis.order() - m);
        GuardedArray<Real> all(rows * count, side), last(rows, side);
        basis.theta(m, points.all(), all.data());
        basis.theta(m, points.all().last(1), last.data());
        for (std::size_t l = 0; l < rows; ++l) ASSERT_EQ(all[l * count + count - 1], last[l]);
    }
}

TEST(VectorMemory, BasesStayWithinDirectionsAndValues) {
    forEveryTarget([] {
        for (const char* family : families)
            for (const int order : {1, 3, 7, 10, 11, 18}) {
                const auto basis = bases::make(family, order);
                for (const std::size_t count : {1, 2, 3, 5, 8, 9, 16, 17, 33, 65})
                    for (const Side side : sides) {
                        checkBasis<double>(*basis, count, side);
                        checkBasis<float>(*basis, count, side);
                        checkTheta<double>(*basis, count, side);
                        checkTheta<float>(*basis, count, side);
                        if (testing::Test::HasFatalFailure()) return;
                    }
            }
    });
}

/// A turn about z alone, whose action on the functions of one m is a turn by m times the angle.
TEST(VectorMemory, RotationsStayWithinCoefficients) {
    constexpr double angle = 0.7;
    forEveryTarget([] {
        for (const int order : {1, 2, 3, 4, 7, 9, 10, 11, 20}) {
            const ShRotation rotation(order);
            const auto slots = static_cast<std::size_t>(order * order);
            for (std::size_t count = 1; count <= 17; ++count)
                for (const Side side : sides) {
                    const GuardedArray<double> in(count * slots, side, [](std::size_t k) {
                        return std::sin(1.3 * static_cast<double>(k));
                    });
                    GuardedArray<double> out(count * slots, side);
                    const std::vector<Rotation> turns(count, Rotation::euler(angle, 0, 0));
                    rotation.rotate(turns, 1, in.data(), out.data());
                    for (std::size_t v = 0; v < count; ++v)
                        for (int l = 0; l < order; ++l)
                            for (int m = 1; m <= l; ++m) {
                                const double* c =
                                    in.data() + v * slots + static_cast<std::size_t>(l * (l + 1));
                                const double* turned = out.data() + (c - in.data());
                                ASSERT_NEAR(
                                    turned[m],
                                    std::cos(m * angle) * c[m] - std::sin(m * angle) * c[-m], 1e-12)
                                    << order << ": " << l << " " << m << " of " << v;
                            }
                }
        }
    });
}

TEST(VectorMemory, QuarterTurnsStayWithinABand) {
    constexpr int order = 40;
    const kernels::QuarterTables tables(order);
    forEveryTarget([&] {
        for (int l = 0; l < order; ++l)
            for (const Side side : sides) {
                const auto length = static_cast<std::size_t>(l) + 1;
                GuardedArray<double> rows(kernels::rowOffset(length), side);
                kernels::quarterRows(l, tables.steps(l), rows.data());
                const std::size_t padded = kernels::padded(length);
                const GuardedArray<double> in(2 * padded, side, [&](std::size_t k) {
                    if (k % padded >= length || k == padded) return 0.0;
                    return std::cos(0.8 * static_cast<double>(k));
                });
                // The matrix is its own inverse, but for the factor of m = 0.
                GuardedArray<double> once(2 * padded, side), twice(2 * padded, side);
                kernels::applyQuarter(l, rows.data(), in.data(), once.data());
                once[0] *= 0.5;
                once[padded] = 0;
                kernels::applyQuarter(l, rows.data(), once.data(), twice.data());
                twice[0] *= 0.5;
                for (std::size_t k = 0; k < 2 * padded; ++k)
                    ASSERT_NEAR(k == padded ? 0 : twice[k], in[k], 1e-12) << l;
            }
    });
}

}  // namespace
}  // namespace hshfit
