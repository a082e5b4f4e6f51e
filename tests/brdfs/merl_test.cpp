#include <brdfs/measured/merl.h>

#include <brdfs/measured_files.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

namespace hshfit {
namespace {

using brdfs::MerlBrdf;
using brdfs::MerlInterpolation;
using brdfs::merlScale;
using test::expectInputError;
using test::merlFile;
using test::TemporaryFile;

/// Fractional indices by the book (Rusinkiewicz 1998): wi is turned by -phi_h about the normal,
/// then by -theta_h about the y axis.
struct Indices {
    double h, d, p;
};
Indices indicesOf(const Direction& wi, const Direction& wo, int azimuths = 180) {
    const long double hx = static_cast<long double>(wi.x) + wo.x;
    const long double hy = static_cast<long double>(wi.y) + wo.y;
    const long double hz = static_cast<long double>(wi.z) + wo.z;
    const long double thetaHalf = std::atan2(std::hypot(hx, hy), hz), phiHalf = std::atan2(hy, hx);
    const long double x = wi.x * std::cos(phiHalf) + wi.y * std::sin(phiHalf);
    const long double y = wi.y * std::cos(phiHalf) - wi.x * std::sin(phiHalf);
    const long double dx = x * std::cos(thetaHalf) - wi.z * std::sin(thetaHalf);
    const long double dz = x * std::sin(thetaHalf) + wi.z * std::cos(thetaHalf);
    const long double degree = 180 / std::acos(-1.0L);
    long double p = std::atan2(y, dx) * degree;
    if (p < 0) p += azimuths;
    const long double d = std::atan2(std::hypot(dx, y), dz) * degree;
    return {static_cast<double>(90 * std::sqrt(thetaHalf * degree / 90)), static_cast<double>(d),
            static_cast<double>(p)};
}

/// The directions at given indices, by the same rotations the other way round.
std::pair<Direction, Direction> directionsAt(double h, double d, double p) {
    const double thetaHalf = (h / 90) * (h / 90) * pi / 2;
    const Direction half{std::sin(thetaHalf), 0, std::cos(thetaHalf)};
    const double sd = std::sin(radians(d)), cd = std::cos(radians(d));
    const double dx = sd * std::cos(radians(p)), dy = sd * std::sin(radians(p));
    const Direction wi{dx * half.z + cd * half.x, dy, cd * half.z - dx * half.x};
    const double c = 2 * dot(half, wi);
    return {wi, {c * half.x - wi.x, c * half.y - wi.y, c * half.z - wi.z}};
}

std::vector<double> at(const Brdf& brdf, double h, double d, double p) {
    const auto [wi, wo] = directionsAt(h, d, p);
    EXPECT_GT(std::min(wi.z, wo.z), 0) << h << " " << d << " " << p;
    return evaluate(brdf, wi, wo);
}

double linearCells(int c, int h, int d, int p) {
    return (c + 1) * (1 + h + 100.0 * d + 1e4 * p + 0.01 * h * d);
}

/// A file and what it opens as.
struct Table {
    explicit Table(const test::MerlCells& cells,
                   MerlInterpolation interpolation = MerlInterpolation::linear, int azimuths = 180)
        : file(merlFile(cells, azimuths)), brdf(file.path(), interpolation) {}
    TemporaryFile file;
    MerlBrdf brdf;
};

TEST(Merl, nodesHaveTheStoredValuesTimesTheScales) {
    const Table linear(linearCells), nearest(linearCells, MerlInterpolation::nearest);
    std::mt19937 random(7);
    for (int i = 0; i < 2000; ++i) {
        const int h = static_cast<int>(random() % 60), d = static_cast<int>(random() % 40);
        const int p = static_cast<int>(random() % 180);
        const auto a = at(linear.brdf, h, d, p), b = at(nearest.brdf, h, d, p);
        for (int c = 0; c < 3; ++c) {
            // phi_d does not exist at theta_d = 0 or theta_h = 0, and theta_h = 0 is only reached
            // to the square root of the rounding error.
            if (h == 0 || d == 0) continue;
            const double stored = linearCells(c, h, d, p) * merlScale[c];
            EXPECT_NEAR(a[c], stored, 1e-8 * stored) << h << " " << d << " " << p;
            EXPECT_DOUBLE_EQ(b[c], stored) << h << " " << d << " " << p;
        }
    }
}

TEST(Merl, indicesAreAccurateToABillionth) {
    const Table h([](int, int i, int, int) { return i; });
    const Table d([](int, int, int i, int) { return i; });
    const Table p([](int, int, int, int i) { return i; });
    std::mt19937 random(8);
    int compared = 0;
    for (int i = 0; i < 20000; ++i) {
        const Direction wi = test::randomDirection(random), wo = test::randomDirection(random);
        const Indices indices = indicesOf(wi, wo);
        // Beyond the last node the table is constant, and the last step in phi_d leads back to 0.
        if (indices.h > 89 || indices.d > 89 || indices.p > 179) continue;
        ++compared;
        EXPECT_NEAR(evaluate(h.brdf, wi, wo)[0] / merlScale[0], indices.h, 1e-9);
        EXPECT_NEAR(evaluate(d.brdf, wi, wo)[0] / merlScale[0], indices.d, 1e-9);
        EXPECT_NEAR(evaluate(p.brdf, wi, wo)[0] / merlScale[0], indices.p, 1e-9);
    }
    EXPECT_GT(compared, 19000);
}

TEST(Merl, interpolatesLinearlyInAllThreeIndices) {
    const Table table(linearCells);
    std::mt19937 random(9);
    for (int i = 0; i < 5000; ++i) {
        const Direction wi = test::randomDirection(random), wo = test::randomDirection(random);
        const auto [h, d, p] = indicesOf(wi, wo);
        if (h > 89 || d > 89 || p > 179) continue;
        const std::vector<double> values = evaluate(table.brdf, wi, wo);
        for (int c = 0; c < 3; ++c) {
            const double expected =
                (c + 1) * (1 + h + 100 * d + 1e4 * p + 0.01 * h * d) * merlScale[c];
            EXPECT_NEAR(values[c], expected, 1e-9 * expected);
        }
    }
}

TEST(Merl, azimuthGoesRound) {
    const Table table([](int, int, int, int p) { return p; });
    const double scale = merlScale[0];
    EXPECT_NEAR(at(table.brdf, 40, 30, 179.25)[0], 0.75 * 179 * scale, 1e-9);
    EXPECT_NEAR(at(table.brdf, 40, 30, 180.25)[0], 0.25 * scale, 1e-9);
    EXPECT_NEAR(at(table.brdf, 40, 30, -0.25)[0], 0.25 * 179 * scale, 1e-9);
    const Table nearest([](int, int, int, int p) { return p; }, MerlInterpolation::nearest);
    EXPECT_DOUBLE_EQ(at(nearest.brdf, 40, 30, 179.75)[0], 0);
    EXPECT_DOUBLE_EQ(at(nearest.brdf, 40, 30, 179.25)[0], 179 * scale);
}

TEST(Merl, continuesConstantlyBeyondTheLastNodes) {
    const Table table(linearCells);
    EXPECT_NEAR(at(table.brdf, 89.6, 0.5, 90)[0], at(table.brdf, 89, 0.5, 90)[0], 1e-6);
    EXPECT_NEAR(at(table.brdf, 1, 89.5, 90)[0], at(table.brdf, 1, 89, 90)[0], 1e-6);
}

TEST(Merl, holdsItsLawsOnATableWithoutAnySymmetry) {
    const Table table([](int c, int h, int d, int p) {
        return static_cast<double>((c * 7919 + h * 104729 + d * 1299709 + p * 15485863LL) % 1000);
    });
    ASSERT_TRUE(table.brdf.laws().isotropic && table.brdf.laws().reciprocal);
    std::mt19937 random(10);
    double mirrorDefect = 0;
    for (int i = 0; i < 5000; ++i) {
        const Direction wi = test::randomDirection(random), wo = test::randomDirection(random);
        const double f = evaluate(table.brdf, wi, wo)[0];
        const double turn = 0.1 + i;
        EXPECT_GE(f, 0);
        EXPECT_NEAR(evaluate(table.brdf, wo, wi)[0], f, 1e-9);
        EXPECT_NEAR(evaluate(table.brdf, rotateAboutZ(wi, turn), rotateAboutZ(wo, turn))[0], f,
                    1e-9);
        const double mirror = evaluate(table.brdf, {wi.x, -wi.y, wi.z}, {wo.x, -wo.y, wo.z})[0];
        mirrorDefect = std::max(mirrorDefect, std::fabs(mirror - f));
    }
    // phi_d and 180 deg - phi_d are separate cells: mirror symmetry is up to the data.
    EXPECT_GT(mirrorDefect, 0.1);
    EXPECT_FALSE(table.brdf.laws().mirrorSymmetric);
}

TEST(Merl, theExactMirrorDirectionDoesNotDependOnTheAzimuth) {
    const Table table([](int, int, int, int p) { return p; });
    for (const double theta : {0.0, 0.3, 1.2}) {
        const double f =
            evaluate(table.brdf, directionFromAngles(theta, pi), directionFromAngles(theta, 0))[0];
        for (int i = 0; i < 50; ++i) {
            const Direction wo = directionFromAngles(theta, i);
            EXPECT_NEAR(evaluate(table.brdf, mirrored(wo), wo)[0], f, 1e-6);
        }
    }
}

TEST(Merl, threeHundredAndSixtyAzimuthsTellTheSidesApart) {
    const Table table([](int, int, int, int p) { return p; }, MerlInterpolation::linear, 360);
    EXPECT_FALSE(table.brdf.laws().reciprocal);
    const auto [wi, wo] = directionsAt(40, 30, 100);
    EXPECT_NEAR(evaluate(table.brdf, wi, wo)[0], 100 * merlScale[0], 1e-9);
    EXPECT_NEAR(evaluate(table.brdf, wo, wi)[0], 280 * merlScale[0], 1e-9);
    EXPECT_NEAR(at(table.brdf, 40, 30, 359.5)[0], 0.5 * 359 * merlScale[0], 1e-9);
}

TEST(Merl, onlyValidCellsCount) {
    // Invalid in two ways, in one channel only: the others keep all eight cells.
    const Table table([](int c, int h, int d, int) {
        if (c != 1 || h < 40) return 10.0;
        return h == 40 ? (d % 2 == 0 ? 20.0 : -1.0) : -0.25;
    });
    const auto values = at(table.brdf, 39.5, 20.5, 50.5);
    EXPECT_NEAR(values[0], 10 * merlScale[0], 1e-12);
    // Weights: two rows of 10 at 1/4 each, one of 20 at 1/4.
    EXPECT_NEAR(values[1], (0.25 * 10 + 0.25 * 10 + 0.25 * 20) / 0.75 * merlScale[1], 1e-9);
    EXPECT_NEAR(values[2], 10 * merlScale[2], 1e-12);
    EXPECT_EQ(at(table.brdf, 41.5, 20.5, 50.5)[1], 0);
    EXPECT_NO_THROW(table.brdf.checkIntact());
}

TEST(Merl, cellsThatAreNotFiniteAreReportedWhenMet) {
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
        for (const auto mode : {MerlInterpolation::linear, MerlInterpolation::nearest}) {
            const Table table(
                [bad](int c, int h, int d, int p) {
                    return c == 2 && h == 41 && d == 20 && p == 51 ? bad : 3.0;
                },
                mode);
            EXPECT_NEAR(at(table.brdf, 30.5, 20.5, 50.5)[2], 3 * merlScale[2], 1e-12);
            EXPECT_NO_THROW(table.brdf.checkIntact());
            EXPECT_TRUE(std::isfinite(at(table.brdf, 40.9, 20.1, 50.9)[2]));
            expectInputError(
                [&] { table.brdf.checkIntact(); },
                {table.file.path(), "theta_h 41, theta_d 20, phi_d 51", "channel B",
                 "offset " + std::to_string(12 + 8 * (2 * 1458000 + 51 + 180 * (20 + 90 * 41)))});
        }
    }
}

TEST(Merl, batchesEqualSingleEvaluations) {
    const Table table(linearCells);
    std::mt19937 random(11);
    for (const std::size_t count : {0, 1, 63, 64, 65, 200}) {
        std::vector<double> x, y, z, out(3 * count);
        for (std::size_t k = 0; k < count; ++k) {
            const Direction wi = test::randomDirection(random, -0.5);
            x.push_back(wi.x), y.push_back(wi.y), z.push_back(wi.z);
        }
        const Direction wo = test::randomDirection(random);
        table.brdf.eval(wo, {x.data(), y.data(), z.data(), count}, out.data());
        for (std::size_t k = 0; k < count; ++k) {
            const auto single = evaluate(table.brdf, {x[k], y[k], z[k]}, wo);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_EQ(out[c * count + k], single[c]);
                if (z[k] <= 0) {
                    EXPECT_EQ(single[c], 0);
                }
            }
        }
    }
    EXPECT_EQ(evaluate(table.brdf, {0, 0, 1}, {0.6, 0, -0.8}), std::vector<double>(3, 0.0));
}

TEST(Merl, censusCountsTheStoredValues) {
    const Table table([](int c, int h, int d, int p) {
        if (c == 0 && h == 10 && d == 10) return p < 5 ? std::nan("") : p < 8 ? INFINITY : 7.0;
        if (c == 1 && h == 11 && d == 10) return p < 4 ? -1.0 : p < 10 ? -0.5 : 6.0;
        return brdfs::merlBelowHorizon(h, d, p) ? -1.0 : 2.0;
    });
    std::uint64_t below = 0;
    for (int h = 0; h < 90; ++h)
        for (int d = 0; d < 90; ++d)
            for (int p = 0; p < 180; ++p) below += brdfs::merlBelowHorizon(h, d, p) ? 3 : 0;
    const brdfs::Census census = table.brdf.census();
    EXPECT_EQ(census.values, 3u * 1458000u);
    EXPECT_EQ(census.belowHorizon, below);
    EXPECT_EQ(census.invalid, 4u);
    EXPECT_EQ(census.negative, 6u);
    EXPECT_EQ(census.notANumber, 5u);
    EXPECT_EQ(census.infinite, 3u);
    EXPECT_NEAR(census.least, -0.5 * merlScale[1], 1e-12);
    EXPECT_NEAR(census.greatest, 7 * merlScale[0], 1e-12);
}

TEST(Merl, coversWhatValidCellsSurround) {
    const Table table(
        [](int c, int h, int d, int) { return c == 1 && h > 40 && d > 50 ? -1.0 : 2.0; });
    const auto covered = [&](double h, double d) {
        const auto pair = brdfs::merlDirections(h, d, 90);
        unsigned char result = 2;
        table.brdf.coverage(pair.wo, {&pair.wi.x, &pair.wi.y, &pair.wi.z, 1}, &result);
        return int(result);
    };
    EXPECT_EQ(covered(20, 20), 1);
    EXPECT_EQ(covered(40.5, 60.5), 1) << "one side is valid";
    EXPECT_EQ(covered(41.5, 60.5), 0);
    EXPECT_EQ(covered(70, 80), 0);
}

// 361,784 of the 1,458,000 bin centres: a published property of the layout.
TEST(Merl, binCentresBelowTheHorizon) {
    int below = 0;
    for (int h = 0; h < 90; ++h)
        for (int d = 0; d < 90; ++d)
            for (int p = 0; p < 180; ++p)
                below += brdfs::merlBelowHorizon(h + 0.5, d + 0.5, p + 0.5) ? 1 : 0;
    EXPECT_EQ(below, 361784);
}

TEST(Merl, lobesAreAsWideAsTheTable) {
    // A GGX-like fall-off with alpha 0.1 on a base.
    const Table table([](int, int h, int, int) {
        const double slope = std::tan(h / 90.0 * h / 90.0 * pi / 2) / 0.1;
        return 1 + 1000 / std::pow(1 + slope * slope, 2);
    });
    const auto lobes = table.brdf.lobes(directionFromAngles(0.5, 0));
    ASSERT_EQ(lobes.size(), 1u);
    EXPECT_EQ(lobes[0].about, Lobe::About::halfway);
    EXPECT_NEAR(lobes[0].width, 0.1, 0.02);
    EXPECT_TRUE(Table([](int, int, int, int) { return 1.0; }).brdf.lobes({0, 0, 1}).empty());
}

}  // namespace
}  // namespace hshfit
