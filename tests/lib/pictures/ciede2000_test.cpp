// CIEDE2000 against the published pairs, and by its laws.

#include <hshfit/pictures/ciede2000.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace hshfit {
namespace {

struct Published {
    Lab x, y;
    double difference;
};

/// From table 1 of Sharma, Wu & Dalal 2005: hues around blue and their discontinuities, greys,
/// large differences, and pairs of measured colours.
constexpr std::array<Published, 27> published{{
    {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
    {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
    {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
    {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
    {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1.0000},
    {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1.0000},
    {{50, 0, 0}, {50, -1, 2}, 2.3669},
    {{50, -1, 2}, {50, 0, 0}, 2.3669},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
    {{50, -0.0010, 2.4900}, {50, 0.0009, -2.4900}, 4.8045},
    {{50, -0.0010, 2.4900}, {50, 0.0011, -2.4900}, 4.7461},
    {{50, 2.5000, 0}, {50, 0, -2.5000}, 4.3065},
    {{50, 2.5000, 0}, {73, 25, -18}, 27.1492},
    {{50, 2.5000, 0}, {61, -5, 29}, 22.8977},
    {{50, 2.5000, 0}, {56, -27, -3}, 31.9030},
    {{50, 2.5000, 0}, {58, 24, 15}, 19.4535},
    {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
    {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
    {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
    {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
    {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
    {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
    {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
    {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
    {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
    {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
}};

TEST(Ciede2000, IsThatOfThePublishedPairs) {
    for (const Published& pair : published) {
        EXPECT_NEAR(ciede2000(pair.x, pair.y), pair.difference, 5.1e-5) << pair.difference;
        EXPECT_NEAR(ciede2000(pair.y, pair.x), pair.difference, 5.1e-5) << pair.difference;
        EXPECT_EQ(ciede2000(pair.x, pair.x), 0);
    }
}

TEST(Ciede2000, OfGreysIsTheirWeightedLightness) {
    // Without chroma only lightness is left: |dL| / S_L.
    for (const double mean : {10.0, 50.0, 90.0}) {
        const double from = (mean - 50) * (mean - 50);
        const double weight = 1 + 0.015 * from / std::sqrt(20 + from);
        EXPECT_NEAR(ciede2000({mean - 1, 0, 0}, {mean + 1, 0, 0}), 2 / weight, 1e-12);
    }
}

TEST(Lab, OfThePrimariesIsThePublishedOne) {
    // CIE L*a*b* of the sRGB primaries, D65, 2 degrees (Lindbloom); his white has other digits.
    const auto near = [](const Lab& lab, double lightness, double a, double b) {
        EXPECT_NEAR(lab.lightness, lightness, 0.02);
        EXPECT_NEAR(lab.a, a, 0.05);
        EXPECT_NEAR(lab.b, b, 0.05);
    };
    near(labOf({1, 0, 0}), 53.2408, 80.0925, 67.2032);
    near(labOf({0, 1, 0}), 87.7347, -86.1827, 83.1793);
    near(labOf({0, 0, 1}), 32.2970, 79.1875, -107.8602);
    near(labOf({1, 1, 1}), 100, 0, 0);
    near(labOf({0, 0, 0}), 0, 0, 0);
    // 18 % grey: 116 cbrt(0.18) - 16.
    near(labOf({0.18, 0.18, 0.18}), 116 * std::cbrt(0.18) - 16, 0, 0);
}

}  // namespace
}  // namespace hshfit
