#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/transfer/windows.h>

#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace hshfit {
namespace {

Direction randomDirection(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const Direction d{normal(random), normal(random), normal(random)};
    const double length = std::sqrt(dot(d, d));
    return {d.x / length, d.y / length, d.z / length};
}

/// A lamp: all bands of a point at `d`.
std::vector<double> lamp(int order, const Direction& d, bool phase = false) {
    std::vector<double> c(static_cast<std::size_t>(order) * order);
    bases::make("sh", order, {.condonShortley = phase})->evaluate(d, c.data());
    return c;
}

std::vector<double> windowedBy(std::vector<double> c, const std::vector<double>& factors) {
    for (std::size_t i = 0; i < c.size(); ++i) {
        c[i] *= factors[static_cast<std::size_t>(std::sqrt(static_cast<double>(i) + 0.5))];
    }
    return c;
}

TEST(Windows, MinimaOfLegendrePolynomialsAboutAnyAxis) {
    std::mt19937_64 random(1);
    for (int trial = 0; trial < 20; ++trial) {
        const Direction axis = trial == 0 ? Direction{0, 0, 1} : randomDirection(random);
        // sum over m of Y_lm(axis) Y_lm = (2l + 1)/(4 pi) P_l, with minima -1/2, -1 and -3/7.
        for (const auto& [l, least] : {std::pair(2, -0.5), {3, -1.0}, {4, -3.0 / 7}}) {
            for (const bool phase : {false, true}) {
                std::vector<double> c = lamp(l + 1, axis, phase);
                std::fill(c.begin(), c.begin() + l * l, 0.0);
                EXPECT_NEAR(minimumOnSphere(c, l + 1, phase), (2 * l + 1) / (4 * pi) * least, 1e-9);
            }
        }
    }
}

TEST(Windows, TheLeastNegativeWindowIsNonNegativeAndNoneWeakerIs) {
    std::mt19937_64 random(2);
    for (const int order : {3, 6, 10}) {
        for (int trial = 0; trial < 3; ++trial) {
            // Two lamps in two channels.
            std::vector<double> c;
            for (int channel = 0; channel < 2; ++channel) {
                std::vector<double> one = lamp(order, randomDirection(random));
                const std::vector<double> other = lamp(order, randomDirection(random));
                for (std::size_t i = 0; i < one.size(); ++i) one[i] += 0.3 * other[i];
                c.insert(c.end(), one.begin(), one.end());
            }
            const LeastNegative found = leastNegativeWindow(c, order);
            EXPECT_NE(found.window, Window::none);
            EXPECT_EQ(found.factors[0], 1);
            EXPECT_GE(found.minimum, -1e-9);
            const auto basis = bases::make("sh", order);
            const auto slots = static_cast<std::size_t>(basis->slots());
            std::vector<double> values(slots);
            const auto channelOf = [&](std::size_t k, const std::vector<double>& factors) {
                const auto from = c.begin() + static_cast<long>(k * slots);
                return windowedBy({from, from + static_cast<long>(slots)}, factors);
            };
            for (std::size_t k = 0; k < 2; ++k) {
                const std::vector<double> windowed = channelOf(k, found.factors);
                const double mean = windowed[0] / std::sqrt(4 * pi);
                for (int sample = 0; sample < 2000; ++sample) {
                    basis->evaluate(randomDirection(random), values.data());
                    EXPECT_GE(
                        std::inner_product(values.begin(), values.end(), windowed.begin(), 0.0),
                        -1e-8 * mean);
                }
            }
            const std::vector<double> weaker =
                found.window == Window::bending
                    ? windowFactors(Window::bending, order, found.lambda * 0.99)
                    : windowOfWidth(found.window, order, found.width * 1.01);
            const double lowest = std::min(minimumOnSphere(channelOf(0, weaker), order),
                                           minimumOnSphere(channelOf(1, weaker), order));
            EXPECT_LT(lowest, 0);
        }
    }
}

TEST(Windows, NonNegativeFunctionsStayAndNegativeMeansAreRefused) {
    // (1 + z)/2 touches 0 at the lower pole.
    const std::vector<double> c{std::sqrt(pi), 0, std::sqrt(pi / 3), 0};
    const LeastNegative none = leastNegativeWindow(c, 2);
    EXPECT_EQ(none.window, Window::none);
    EXPECT_EQ(none.factors, (std::vector<double>{1, 1}));
    EXPECT_EQ(none.change, 0);
    EXPECT_THROW(leastNegativeWindow(std::vector<double>{-1, 0, 0, 0}, 2), NumericError);
    EXPECT_THROW(leastNegativeWindow(std::vector<double>{std::nan(""), 0, 0, 0}, 2), NumericError);
    EXPECT_THROW(leastNegativeWindow(std::vector<double>(5), 2), UsageError);
    EXPECT_THROW(leastNegativeWindow(std::vector<double>(), 2), UsageError);
    EXPECT_THROW(minimumOnSphere(std::vector<double>(5), 2), UsageError);
    EXPECT_EQ(leastNegativeWindow(std::vector<double>(4), 2).window, Window::none);
}

}  // namespace
}  // namespace hshfit
