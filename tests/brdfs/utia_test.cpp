#include <brdfs/catalog.h>
#include <brdfs/measured/gridded/utia.h>

#include <brdfs/gridded_files.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hshfit {
namespace {

using brdfs::UtiaBrdf;
using brdfs::UtiaOptions;
using test::UtiaCells;
using test::utiaFile;

UtiaBrdf table(const UtiaCells& cells, const UtiaOptions& options = {}) {
    const std::string bytes = utiaFile(cells);
    return {{reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, "table", options};
}

Direction at(double theta, double phi) {
    return directionFromAngles(radians(theta), radians(phi));
}

/// Without any symmetry, the same for all azimuths of a direction at the normal.
double uneven(int c, int ti, int pi, int tv, int pv) {
    const int i = ti == 0 ? 0 : 48 * ti + pi, v = tv == 0 ? 0 : 48 * tv + pv;
    return static_cast<double>(1 + (c * 7919 + i * 104729 + v * 15485863LL) % 1000);
}

/// The sixteen nodes by the book, in long double.
long double byTheBook(int c, const Direction& wi, const Direction& wo) {
    const auto place = [](const Direction& d, int node[2][2], long double t[2]) {
        const long double degree = 180 / std::acos(-1.0L);
        const long double theta =
            std::atan2(std::hypot(static_cast<long double>(d.x), d.y), d.z) * degree / 15;
        long double phi = std::atan2(static_cast<long double>(d.y), d.x) * degree / 7.5L;
        if (phi < 0) phi += 48;
        const int low = std::min(static_cast<int>(theta), 4), p = static_cast<int>(phi);
        node[0][0] = low, node[0][1] = low + 1;
        node[1][0] = p % 48, node[1][1] = (p + 1) % 48;
        t[0] = theta - low, t[1] = phi - p;
    };
    int i[2][2], v[2][2];
    long double ti[2], tv[2], sum = 0;
    place(wi, i, ti);
    place(wo, v, tv);
    for (int corner = 0; corner < 16; ++corner) {
        const int a = corner & 1, b = corner >> 1 & 1, e = corner >> 2 & 1, f = corner >> 3;
        sum += (a ? ti[0] : 1 - ti[0]) * (b ? ti[1] : 1 - ti[1]) * (e ? tv[0] : 1 - tv[0]) *
               (f ? tv[1] : 1 - tv[1]) * uneven(c, i[0][a], i[1][b], v[0][e], v[1][f]);
    }
    return std::max(sum, 0.0L);
}

TEST(Utia, nodesHaveTheStoredValues) {
    const UtiaBrdf brdf = table(uneven);
    for (int ti = 0; ti < 6; ++ti)
        for (int tv = 0; tv < 6; ++tv)
            for (int p = 0; p < 48; p += 5) {
                const int pv = (7 * p + 3) % 48;
                const auto f = evaluate(brdf, at(15 * ti, 7.5 * p), at(15 * tv, 7.5 * pv));
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(f[c], uneven(c, ti, p, tv, pv), 1e-6) << ti << " " << tv;
                }
            }
}

TEST(Utia, isMultilinearInTheFourAngles) {
    const UtiaBrdf brdf = table(uneven);
    std::mt19937 random(1);
    int clamped = 0;
    for (int k = 0; k < 5000; ++k) {
        const Direction wi = test::randomDirection(random), wo = test::randomDirection(random);
        const auto f = evaluate(brdf, wi, wo);
        for (int c = 0; c < 3; ++c) {
            const auto expected = static_cast<double>(byTheBook(c, wi, wo));
            EXPECT_NEAR(f[c], expected, 1e-6) << wi.z << " " << wo.z;
            clamped += expected == 0;
        }
    }
    EXPECT_GT(clamped, 10) << "extrapolation has to fall below 0 somewhere";
}

TEST(Utia, azimuthGoesRound) {
    const UtiaBrdf brdf = table([](int, int, int pi, int, int) { return pi; });
    EXPECT_NEAR(evaluate(brdf, at(30, 356.25), at(30, 10))[0], 23.5, 1e-8);
    EXPECT_NEAR(evaluate(brdf, at(30, -0.75), at(30, 10))[0], 0.1 * 47, 1e-8);
    EXPECT_NEAR(evaluate(brdf, at(30, 352.5), at(30, 10))[0], 47, 1e-8);
}

TEST(Utia, continuesLinearlyOrConstantlyPast75Degrees) {
    const UtiaCells falling = [](int, int ti, int, int, int) { return 5.5 - ti; };
    const UtiaBrdf linear = table(falling);
    const UtiaBrdf constant = table(falling, {.beyond = UtiaOptions::Beyond::constant});
    const Direction wo = at(20, 0);
    EXPECT_NEAR(evaluate(linear, at(78, 0), wo)[0], 0.3, 1e-8);
    EXPECT_EQ(evaluate(linear, at(84, 0), wo)[0], 0);
    EXPECT_NEAR(evaluate(constant, at(84, 0), wo)[0], 0.5, 1e-8);
    for (const auto& [name, value] : linear.facts()) {
        // 7 of the 13 pairs of rings with theta = 90 deg have it for wi and are negative.
        if (name == "of_these_negative") {
            EXPECT_EQ(std::get<std::int64_t>(value), 7 * 48 * 48 * 3);
        }
        if (name == "values_continued_to_horizon") {
            EXPECT_EQ(std::get<std::int64_t>(value), 13 * 48 * 48 * 3);
        }
    }
    const Direction wi[] = {at(74.9, 3), at(75.1, 3), at(10, 0)};
    for (const auto& [out, expected] : {std::pair{at(70, 9), "\1\0\1"}, {at(80, 9), "\0\0\0"}}) {
        for (int k = 0; k < 3; ++k) {
            unsigned char covered = 2;
            linear.coverage(out, {&wi[k].x, &wi[k].y, &wi[k].z, 1}, &covered);
            EXPECT_EQ(covered, expected[k]) << k;
        }
    }
}

TEST(Utia, theNormalHasOneValue) {
    // 0 to 47 in azimuth of wi, on a plane that depends on the view.
    const UtiaBrdf brdf = table(
        [](int, int ti, int pi, int tv, int) { return ti == 0 ? pi + 100 * tv : 50 + 100 * tv; });
    for (int k = 0; k < 10; ++k) {
        EXPECT_NEAR(evaluate(brdf, {0, 0, 1}, at(15, 36 * k))[0], 123.5, 1e-9);
        EXPECT_NEAR(evaluate(brdf, at(1e-7, 36 * k), at(15, 0))[0], 123.5, 1e-4);
    }
    for (const auto& [name, value] : brdf.facts()) {
        if (name == "largest_spread_at_normal") {
            EXPECT_NEAR(std::get<double>(value), 1, 1e-12);  // 0 to 47 for tv = 0
        }
    }
}

TEST(Utia, batchesEqualSingleEvaluations) {
    const UtiaBrdf brdf = table(uneven);
    std::mt19937 random(2);
    for (const std::size_t count : {0, 1, 63, 71, 72, 200}) {
        std::vector<double> x, y, z, out(3 * count);
        for (std::size_t k = 0; k < count; ++k) {
            const Direction wi = test::randomDirection(random, -0.5);
            x.push_back(wi.x), y.push_back(wi.y), z.push_back(wi.z);
        }
        const Direction wo = test::randomDirection(random);
        brdf.eval(wo, {x.data(), y.data(), z.data(), count}, out.data());
        for (std::size_t k = 0; k < count; ++k) {
            const auto single = evaluate(brdf, {x[k], y[k], z[k]}, wo);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_EQ(out[c * count + k], single[c]);
                if (z[k] <= 0) {
                    EXPECT_EQ(single[c], 0);
                }
            }
        }
    }
    EXPECT_EQ(evaluate(brdf, {0, 0, 1}, {0.6, 0, -0.8}), std::vector<double>(3, 0.0));
}

TEST(Utia, coloursAreDecoded) {
    // IEC 61966-2-1: half of the code range is 0.21404 of the light.
    const UtiaBrdf srgb = table([](int c, int, int, int, int) { return c == 0 ? 0.5 : 0.04; },
                                {.colours = UtiaOptions::Colours::srgb, .scale = 2});
    const auto f = evaluate(srgb, at(20, 5), at(40, 50));
    EXPECT_NEAR(f[0], 2 * 0.214041, 1e-5);
    EXPECT_NEAR(f[1], 2 * 0.04 / 12.92, 1e-9);
    // D65 is the white of Rec. 709.
    const UtiaBrdf xyz =
        table([](int c, int, int, int, int) { return c == 0   ? 0.9505
                                                     : c == 1 ? 1
                                                              : 1.089; },
              {.colours = UtiaOptions::Colours::xyz});
    for (const double value : evaluate(xyz, at(20, 5), at(40, 50))) EXPECT_NEAR(value, 1, 1e-3);
    EXPECT_EQ(srgb.name(), "table:colours=srgb,scale=2");
}

TEST(Utia, pictureEqualsBinary) {
    const test::TemporaryFile picture({}, ".exr"), binary(utiaFile(uneven), ".bin");
    test::writeExr(picture.path(), 288, 288, Imf::FLOAT, Imf::ZIP_COMPRESSION,
                   {{"R", [](int x, int y) { return uneven(0, y / 48, y % 48, x / 48, x % 48); }},
                    {"G", [](int x, int y) { return uneven(1, y / 48, y % 48, x / 48, x % 48); }},
                    {"B", [](int x, int y) { return uneven(2, y / 48, y % 48, x / 48, x % 48); }}});
    const auto a = brdfs::open(picture.path()), b = brdfs::open(binary.path());
    ASSERT_NE(dynamic_cast<const UtiaBrdf*>(a.get()), nullptr);
    ASSERT_NE(dynamic_cast<const UtiaBrdf*>(b.get()), nullptr);
    std::mt19937 random(3);
    for (int k = 0; k < 200; ++k) {
        const Direction wi = test::randomDirection(random), wo = test::randomDirection(random);
        EXPECT_EQ(evaluate(*a, wi, wo), evaluate(*b, wi, wo));
    }
}

TEST(Utia, halvesWithPizAreReadAsWell) {
    const test::TemporaryFile picture({}, ".exr");
    const auto value = [](int x, int y) { return 0.25 * (x % 7) + y % 5; };  // exact in 11 bits
    test::writeExr(picture.path(), 288, 288, Imf::HALF, Imf::PIZ_COMPRESSION,
                   {{"R", value}, {"G", value}, {"B", value}, {"A", [](int, int) { return 1; }}});
    const auto brdf = brdfs::open(picture.path() + ":beyond=constant");
    EXPECT_NEAR(evaluate(*brdf, at(15, 7.5 * 3), at(30, 7.5 * 10))[1], value(48 * 2 + 10, 48 + 3),
                1e-6);
}

TEST(Utia, censusCountsTheStoredValues) {
    const UtiaBrdf brdf = table([](int c, int ti, int pi, int tv, int pv) {
        if (c == 1 && ti == 2 && tv == 2 && pi == 4) return pv < 3 ? std::nan("") : 1.0;
        if (c == 2 && ti == 2 && tv == 2 && pi == 5) return pv < 4 ? INFINITY : 1.0;
        return c == 0 && ti == 3 && tv == 3 && pi == 0 && pv < 5 ? -0.5 : 2.0;
    });
    const brdfs::Census census = brdf.census();
    EXPECT_EQ(census.values, 3u * 288u * 288u);
    EXPECT_EQ(census.notANumber, 3u);
    EXPECT_EQ(census.infinite, 4u);
    EXPECT_EQ(census.negative, 5u);
    EXPECT_EQ(census.least, -0.5);
    EXPECT_EQ(census.greatest, 2);
    // Filled from the nearest azimuth of view, and reported.
    EXPECT_NEAR(evaluate(brdf, at(30, 30), at(30, 0))[1], 2 - 1, 1e-9);
    const std::size_t index = (288u + 48 * 2 + 4) * 288 + 48 * 2;
    test::expectInputError([&] { brdf.checkIntact(); },
                           {"table", "channel G", "theta_i 30, phi_i 30", "theta_v 30, phi_v 0",
                            "offset " + std::to_string(8 * index)});
    EXPECT_NO_THROW(brdf.checkReadable());
}

}  // namespace
}  // namespace hshfit
