#include <hshfit/error.h>
#include <hshfit/light/internal/perez_sky.h>
#include <hshfit/light/internal/solar_position.h>
#include <hshfit/light/sky.h>

#include <gtest/gtest.h>

#include <cmath>

namespace hshfit {
namespace {

const std::vector<Direction>& skyDirections() {
    static const std::vector<Direction> all = [] {
        std::vector<Direction> directions;
        for (int t = 0; t <= 18; ++t) {
            for (int p = 0; p < 12; ++p) {
                directions.push_back(directionFromAngles(radians(t * 4.99), radians(30 * p + 7)));
            }
        }
        return directions;
    }();
    return all;
}

double angleTo(const Direction& a, const Direction& b) {
    return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
}

/// The older standards of the CIE (1955 overcast; 1973 clear, and clear over a polluted city),
/// which the general sky contains but for the roundings of their coefficients.
TEST(CieSky, ContainsTheStandardsBeforeIt) {
    const auto clear = [](double theta, double chi, double sunTheta, double constant, double c,
                          double e) {
        const auto f = [&](double x) {
            return constant + c * std::exp(-3 * x) + e * std::pow(std::cos(x), 2);
        };
        return (1 - std::exp(-0.32 / std::cos(theta))) * f(chi) /
               ((1 - std::exp(-0.32)) * f(sunTheta));
    };
    for (const double sunTheta : {10.0, 45.0, 80.0}) {
        const Direction sun = directionFromAngles(radians(sunTheta), 0.4);
        const SkyLight overcast = cieSky(1, sun, {1, 1, 1}), clean = cieSky(12, sun, {1, 1, 1}),
                       polluted = cieSky(13, sun, {1, 1, 1}), uniform = cieSky(5, sun, {1, 2, 3});
        for (const Direction& d : skyDirections()) {
            const double theta = polarAngle(d), chi = angleTo(d, sun);
            const double expected = clear(theta, chi, radians(sunTheta), 0.91, 10, 0.45);
            EXPECT_NEAR(radianceOf(clean, d)[1], expected, 2e-3 * expected);
            const double dusty = clear(theta, chi, radians(sunTheta), 0.856, 16, 0.3);
            EXPECT_NEAR(radianceOf(polluted, d)[1], dusty, 2e-3 * dusty);
            EXPECT_EQ(radianceOf(uniform, d), (Rgb{1, 2, 3}));
        }
        // At the horizon exp(b / cos theta) vanishes.
        EXPECT_NEAR(radianceOf(overcast, {1, 0, 0})[0], 1 / (1 + 4 * std::exp(-0.7)), 1e-12);
    }
}

/// Type 13 towards the sun and away from it, by the formula as ISO 15469 prints it, and the zenith
/// as the unit of every type.
TEST(CieSky, FollowsThePrintedFormula) {
    const double sunTheta = radians(50);
    const Direction sun = directionFromAngles(sunTheta, 0);
    const auto f = [](double chi) {
        return 1 + 16 * (std::exp(-3 * chi) - std::exp(-3 * pi / 2)) +
               0.3 * std::pow(std::cos(chi), 2);
    };
    const auto phi = [](double theta) { return 1 - std::exp(-0.32 / std::cos(theta)); };
    const SkyLight sky = cieSky(13, sun, {2, 2, 2});
    for (const double theta : {0.0, 20.0, 50.0, 85.0}) {
        for (const double sign : {1.0, -1.0}) {
            const double chi = std::abs(sign * radians(theta) - sunTheta);
            EXPECT_NEAR(radianceOf(sky, directionFromAngles(sign * radians(theta), 0))[0],
                        2 * f(chi) * phi(radians(theta)) / (f(sunTheta) * phi(0)), 1e-12);
        }
    }
    for (int type = 1; type <= 15; ++type) {
        EXPECT_NEAR(radianceOf(cieSky(type, sun, {3, 3, 3}), {0, 0, 1})[2], 3, 1e-12) << type;
    }
    // Overcast in closed form: the irradiance of 1 + a exp(b / z) is
    // 2 pi (1/2 + a E3(-b)) / (1 + a exp(b)), with E3(0.7) = 0.1602250 (Abramowitz & Stegun 5.4 by
    // recurrence from E1(0.7) = 0.373768843).
    const double e1 = 0.373768843233509;
    const double e2 = std::exp(-0.7) - 0.7 * e1, e3 = (std::exp(-0.7) - 0.7 * e2) / 2;
    EXPECT_NEAR(skyIrradiance(cieSky(1, sun, {1, 1, 1}))[0],
                2 * pi * (0.5 + 4 * e3) / (1 + 4 * std::exp(-0.7)), 1e-6);
}

/// Luminance and chromaticity of the zenith by the appendix of the paper, written out for turbidity
/// 3 and the sun 60 degrees from the zenith.
TEST(PreethamSky, ZenithFollowsThePaper) {
    const double t = 3, s = pi / 3;
    const double luminance =
        (4.0453 * t - 4.9710) * std::tan((4 / 9.0 - t / 120) * (pi - 2 * s)) - 0.2155 * t + 2.4192;
    EXPECT_NEAR(preethamZenithLuminance(t, s), luminance, 1e-12);
    const double s2 = s * s, s3 = s * s * s;
    const double x = t * t * (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s) +
                     t * (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s + 0.00394) + 0.11693 * s3 -
                     0.21196 * s2 + 0.06052 * s + 0.25886;
    const double y = t * t * (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s) +
                     t * (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s + 0.00516) + 0.15346 * s3 -
                     0.26756 * s2 + 0.06670 * s + 0.26688;
    const Rgb zenith = radianceOf(preethamSky(t, directionFromAngles(s, 1), {1, 1, 1}), {0, 0, 1});
    // Back to XYZ by the matrix that IEC 61966-2-1 prints.
    const double cieX = 0.4124 * zenith[0] + 0.3576 * zenith[1] + 0.1805 * zenith[2];
    const double cieY = 0.2126 * zenith[0] + 0.7152 * zenith[1] + 0.0722 * zenith[2];
    const double cieZ = 0.0193 * zenith[0] + 0.1192 * zenith[1] + 0.9505 * zenith[2];
    EXPECT_NEAR(cieY, luminance, 1e-3 * luminance);
    EXPECT_NEAR(cieX / (cieX + cieY + cieZ), x, 2e-4);
    EXPECT_NEAR(cieY / (cieX + cieY + cieZ), y, 2e-4);
}

/// The distribution of Perez et al. with the paper's coefficients for Y, along the sun's meridian.
TEST(PreethamSky, LuminanceFollowsPerez) {
    const double t = 4, sunTheta = radians(40);
    const double a = 0.1787 * t - 1.4630, b = -0.3554 * t + 0.4275, c = -0.0227 * t + 5.3251,
                 d = 0.1206 * t - 2.5771, e = -0.0670 * t + 0.3703;
    const auto perez = [&](double theta, double gamma) {
        return (1 + a * std::exp(b / std::cos(theta))) *
               (1 + c * std::exp(d * gamma) + e * std::pow(std::cos(gamma), 2));
    };
    const SkyLight sky = preethamSky(t, directionFromAngles(sunTheta, 0), {1, 1, 1});
    for (const double theta : {-80.0, -30.0, 5.0, 40.0, 70.0}) {
        const Rgb rgb = radianceOf(sky, directionFromAngles(radians(theta), 0));
        const double expected = preethamZenithLuminance(t, sunTheta) *
                                perez(radians(theta), std::abs(radians(theta) - sunTheta)) /
                                perez(0, sunTheta);
        EXPECT_NEAR(0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2], expected, 1e-3 * expected)
            << theta;
        EXPECT_GT(rgb[2], rgb[0]) << "a clear sky is blue";
    }
    EXPECT_EQ(radianceOf(sky, {0, 0.6, -0.8}), Rgb{});
}

/// The example of the Solar Position Algorithm (Reda & Andreas, NREL/TP-560-34302, 2003/2008):
/// Golden, Colorado, 17 October 2003, 12:30:30 at 7 hours behind Universal Time: topocentric
/// elevation 39.8721 degrees without refraction and azimuth 194.3402; with the refraction of a
/// standard atmosphere 39.89.
TEST(SolarPosition, AgreesWithTheExampleOfSpa) {
    const Moment moment = parseMoment("sun", "2003-10-17", "12:30:30", -7);
    const SolarPosition sun = solarPosition(moment, radians(39.742476), radians(-105.1786));
    EXPECT_NEAR(degrees(sun.elevation), 39.892, 0.012);
    EXPECT_NEAR(degrees(sun.azimuth), 194.3402, 0.015);
    // North of the equator at noon the sun stands in the south, -y.
    EXPECT_LT(directionOf(sun).y, 0);
    EXPECT_NEAR(degrees(azimuth(directionOf(sun))), 90 - 194.3402, 0.015);
}

/// Example 25.a of Meeus, Astronomical Algorithms (1998): at 0h on 13 October 1992 the sun has
/// right ascension 198.38083 and declination -7.78507 degrees; sidereal time in Greenwich is by his
/// (12.4).
TEST(SolarPosition, StandsInTheZenithOfThePlaceThatMeeusGives) {
    const double days = 2448908.5 - 2451545.0;
    const double sidereal = 280.46061837 + 360.98564736629 * days;
    const double longitude = std::remainder(198.38083 - sidereal, 360.0);
    const SolarPosition sun =
        solarPosition({1992, 10, 13, 0}, radians(-7.78507), radians(longitude));
    EXPECT_GT(degrees(sun.elevation), 89.98);
}

/// Sum over rings of equal steps of the sine of elevation; independent of the quadrature of skies.
double horizontalIrradiance(const SkyLight& sky) {
    double sum = 0;
    constexpr int rings = 800, azimuths = 720;
    for (int r = 0; r < rings; ++r) {
        const double z = (r + 0.5) / rings;
        for (int j = 0; j < azimuths; ++j)
            sum += z * radianceOf(sky, directionFromAngles(std::acos(z),
                                                           2 * pi * (j + 0.5) / azimuths))[1];
    }
    return sum * 2 * pi / rings / azimuths;
}

TEST(PerezSky, IrradianceOfTheSkyIsTheMeasuredOne) {
    for (const double elevation : {15.0, 40.0, 65.0})
        for (const auto& [direct, diffuse] :
             {std::pair(0.0, 150.0), {100.0, 250.0}, {300.0, 260.0}, {800.0, 110.0}}) {
            const Direction sun = directionFromAngles(radians(90 - elevation), 0.7);
            const SkyLight sky = perezSky(sun, direct, diffuse, 1367);
            EXPECT_NEAR(horizontalIrradiance(sky), diffuse, 2e-3 * diffuse)
                << elevation << " " << direct;
        }
}

/// The coefficients by hand from table 1 with Z = 1 and a brightness of 0.1: the last row, and the
/// first with its own c and d.
TEST(PerezSky, CoefficientsAreThoseOfThePrintedTable) {
    const Direction sun = directionFromAngles(1, 0);
    const SkyShape clear = perezShape({.clearness = 7, .brightness = 0.1}, sun);
    EXPECT_NEAR(clear.a, -1.05 + 0.0289 + 0.1 * (0.426 + 0.359), 1e-12);
    EXPECT_NEAR(clear.b, -0.325 + 0.1156 + 0.1 * (0.7781 + 0.0025), 1e-12);
    EXPECT_NEAR(clear.c, 31.0625 - 14.5 + 0.1 * (-46.1148 + 55.375), 1e-12);
    EXPECT_NEAR(clear.d, -7.2312 + 0.405 + 0.1 * (13.35 + 0.6234), 1e-12);
    EXPECT_NEAR(clear.e, 1.5 - 0.6426 + 0.1 * (1.8564 + 0.5636), 1e-12);
    EXPECT_EQ(clear.offset, 0);
    const SkyShape overcast = perezShape({.clearness = 1, .brightness = 0.1}, sun);
    EXPECT_NEAR(overcast.c, std::exp(std::pow(0.1 * 3.4004, 1.2375)) - 1, 1e-12);
    EXPECT_NEAR(overcast.d, -std::exp(0.1 * 2.5031) + 0.9738 + 0.1 * 0.2809, 1e-12);
}

/// Kasten's air mass is 1 overhead, and an overcast sky has clearness 1.
TEST(PerezSky, ClearnessAndBrightnessHaveTheirLimits) {
    const PerezWeather none = perezWeather({0, 0, 1}, 0, 136.7, 1367);
    EXPECT_NEAR(none.clearness, 1, 1e-12);
    EXPECT_NEAR(none.brightness, 0.1, 1e-4);
    EXPECT_NEAR(perezWeather({0, 0, 1}, 500, 100, 1367).clearness, 6, 1e-12);
}

}  // namespace
}  // namespace hshfit
