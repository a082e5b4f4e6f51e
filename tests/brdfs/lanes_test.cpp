// The elementary functions of Lanes against the C++ library in long double, over the arguments that
// models have, for every instruction set of the machine.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "brdfs/lanes_cases.h"
#include <brdfs/lanes/each_target.h>

#include <vector_targets.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(lanesExp);
HWY_EXPORT(lanesExpm1);
HWY_EXPORT(lanesLog);
HWY_EXPORT(lanesLog1p);
HWY_EXPORT(lanesErfc);
HWY_EXPORT(lanesIerfc);
HWY_EXPORT(lanesCos);
HWY_EXPORT(lanesSin);
HWY_EXPORT(lanesPow);

constexpr std::size_t count = 40000;

/// Distance in units of the last place of the expected value, if that is normal.
double unitsOff(double value, long double expected) {
    const double rounded = static_cast<double>(expected);
    const double unit = std::nextafter(std::abs(rounded), INFINITY) - std::abs(rounded);
    return static_cast<double>(std::abs(value - expected) / unit);
}

/// Uniform in [low, high], both ends among them.
std::vector<double> uniform(double low, double high, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> between(low, high);
    std::vector<double> all{low, high};
    while (all.size() < count) all.push_back(between(random));
    return all;
}

/// Scales whose logarithms are uniform, of both signs where asked for.
std::vector<double> scales(double least, double most, bool bothSigns) {
    std::vector<double> all = uniform(std::log(least), std::log(most), 2);
    for (std::size_t k = 0; k < all.size(); ++k)
        all[k] =
            std::min(std::max(std::exp(all[k]), least), most) * (bothSigns && k % 2 == 1 ? -1 : 1);
    return all;
}

using Function = void (*)(const double* x, std::size_t size, double* y);

template <class Exact>
void expectWithin(Function function, const std::vector<double>& x, Exact exact, double units) {
    std::vector<double> y(x.size());
    function(x.data(), x.size(), y.data());
    double worst = 0, at = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double off = unitsOff(y[k], exact(static_cast<long double>(x[k])));
        if (!(off <= worst)) worst = off, at = x[k];
    }
    EXPECT_LE(worst, units) << "at " << at;
}

TEST(Lanes, ExpIsWithinItsBound) {
    const auto exact = [](long double x) { return std::exp(x); };
    test::forEveryTarget([&] {
        const auto exp = [](const double* x, std::size_t size, double* y) {
            HWY_DYNAMIC_DISPATCH(lanesExp)(x, size, y);
        };
        expectWithin(exp, uniform(-707, 709.78, 1), exact, 1.5);
        expectWithin(exp, uniform(-1, 1, 2), exact, 1.5);
        expectWithin(exp, scales(1e-300, 1, true), exact, 1.5);
        const double ends[] = {-1e300, -INFINITY, -708, 709.8, 1e300, INFINITY, 0, -0.0};
        double values[8];
        exp(ends, 8, values);
        for (int k = 0; k < 3; ++k) EXPECT_EQ(values[k], 0) << ends[k];
        for (int k = 3; k < 6; ++k) EXPECT_EQ(values[k], INFINITY) << ends[k];
        EXPECT_EQ(values[6], 1);
        EXPECT_EQ(values[7], 1);
    });
}

TEST(Lanes, Expm1IsWithinItsBound) {
    const auto exact = [](long double x) { return std::expm1(x); };
    test::forEveryTarget([&] {
        const auto expm1 = [](const double* x, std::size_t size, double* y) {
            HWY_DYNAMIC_DISPATCH(lanesExpm1)(x, size, y);
        };
        expectWithin(expm1, uniform(-40, 700, 3), exact, 3);
        expectWithin(expm1, uniform(-1, 1, 4), exact, 3);
        expectWithin(expm1, scales(1e-300, 1, true), exact, 3);
    });
}

TEST(Lanes, LogIsWithinItsBound) {
    const auto exact = [](long double x) { return std::log(x); };
    test::forEveryTarget([&] {
        const auto log = [](const double* x, std::size_t size, double* y) {
            HWY_DYNAMIC_DISPATCH(lanesLog)(x, size, y);
        };
        expectWithin(log, scales(5e-324, 1e308, false), exact, 1);
        expectWithin(log, uniform(0.5, 2, 5), exact, 1);
        expectWithin(log, uniform(1 - 1e-7, 1 + 1e-7, 6), exact, 1);
    });
}

TEST(Lanes, Log1pIsWithinItsBound) {
    const auto exact = [](long double x) { return std::log1p(x); };
    test::forEveryTarget([&] {
        const auto log1p = [](const double* x, std::size_t size, double* y) {
            HWY_DYNAMIC_DISPATCH(lanesLog1p)(x, size, y);
        };
        expectWithin(log1p, scales(1e-300, 1e300, false), exact, 3);
        expectWithin(log1p, uniform(-0.999, 3, 7), exact, 3);
        expectWithin(log1p, scales(1e-300, 0.5, true), exact, 3);
    });
}

// Near a zero the error is one of the units of 1.
TEST(Lanes, CosAndSinAreWithinTheirBound) {
    test::forEveryTarget([&] {
        for (const double most : {1., 40., 39000.}) {
            const std::vector<double> x = uniform(-most, most, 8);
            std::vector<double> cosine(x.size()), sine(x.size());
            HWY_DYNAMIC_DISPATCH(lanesCos)(x.data(), x.size(), cosine.data());
            HWY_DYNAMIC_DISPATCH(lanesSin)(x.data(), x.size(), sine.data());
            // 3 units, and half a unit for the standard library.
            const double bound = 3.5 * std::numeric_limits<double>::epsilon();
            for (std::size_t k = 0; k < x.size(); ++k) {
                ASSERT_NEAR(cosine[k], std::cos(x[k]), bound) << x[k];
                ASSERT_NEAR(sine[k], std::sin(x[k]), bound) << x[k];
            }
        }
    });
}

// exp(y log x): errors of the logarithm, |y log x| times.
TEST(Lanes, PowIsWithinItsBound) {
    test::forEveryTarget([&] {
        for (const double power : {-1.27393, -1., .5, 1., 3.7, 50., 850., 1e5}) {
            // Arguments with results between 1e-300 and 1e300.
            const double reach = std::min(690 / std::abs(power), 700.);
            const std::vector<double> x = scales(std::exp(-reach), std::exp(reach), false);
            std::vector<double> y(x.size());
            HWY_DYNAMIC_DISPATCH(lanesPow)(x.data(), power, x.size(), y.data());
            for (std::size_t k = 0; k < x.size(); ++k) {
                const long double exact =
                    std::pow(static_cast<long double>(x[k]), static_cast<long double>(power));
                const double argument = std::abs(power * std::log(x[k]));
                ASSERT_LE(unitsOff(y[k], exact), 1.5 + 2 * argument) << x[k] << "^" << power;
            }
        }
        const double zeros[] = {0, 0, 0, 5e-324};
        double values[4];
        HWY_DYNAMIC_DISPATCH(lanesPow)(zeros, 2.5, 3, values);
        EXPECT_EQ(values[0], 0);
        HWY_DYNAMIC_DISPATCH(lanesPow)(zeros, -1, 3, values);
        EXPECT_EQ(values[2], INFINITY);
        HWY_DYNAMIC_DISPATCH(lanesPow)(zeros, 0, 4, values);
        EXPECT_EQ(values[1], 1);
        EXPECT_EQ(values[3], 1);
    });
}

TEST(Lanes, ErfcIsWithinItsBound) {
    std::vector<double> x = uniform(0, 7, 9);
    for (const double small : scales(1e-300, 1, false)) x.push_back(small);
    const std::vector<double> beyond{8, 1e10, 1e300, static_cast<double>(INFINITY)};
    const std::size_t within = x.size();
    x.insert(x.end(), beyond.begin(), beyond.end());
    test::forEveryTarget([&] {
        std::vector<double> y(x.size());
        HWY_DYNAMIC_DISPATCH(lanesErfc)(x.data(), x.size(), y.data());
        for (std::size_t k = 0; k < within; ++k)
            ASSERT_LE(unitsOff(y[k], std::erfc(static_cast<long double>(x[k]))), 4 + x[k] * x[k])
                << x[k];
        for (std::size_t k = within; k < x.size(); ++k) ASSERT_NEAR(y[k], 2e-23, 2.5e-23) << x[k];
    });
}

// In long double the difference of the formula cancels to 1e-19.
TEST(Lanes, IerfcIsWithinItsBound) {
    std::vector<double> x = uniform(0, 8, 8);
    for (const double beyond : {27., 1e10, 1e300, static_cast<double>(INFINITY)})
        x.push_back(beyond);
    test::forEveryTarget([&] {
        std::vector<double> y(x.size());
        HWY_DYNAMIC_DISPATCH(lanesIerfc)(x.data(), x.size(), y.data());
        for (std::size_t k = 0; k < x.size(); ++k) {
            const long double t = x[k];
            const long double exact =
                x[k] > 20 ? 0 : std::exp(-t * t) / std::sqrt(std::acos(-1.0L)) - t * std::erfc(t);
            ASSERT_NEAR(y[k], static_cast<double>(exact), 1e-15) << x[k];
        }
    });
}

}  // namespace
}  // namespace hshfit::brdfs
