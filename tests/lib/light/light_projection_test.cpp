// Coefficients of light against closed forms (GSL's Legendre functions) and against quadrature of
// each pixel; laws of linearity, of turning, and of threads.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/light/latlong_projection.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/picture_layout.h>
#include <hshfit/quadrature/quadrature.h>

#include <gsl/gsl_sf_legendre.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace hshfit;

namespace {

const Orientation tilted{.theta = 0.7, .phi = 2.1, .turn = 0};

LightCoefficients project(const std::vector<Light>& lights, const std::string& basis, int order,
                          const LightDomain& domain = {}) {
    return projectLight(lights, *bases::make(basis, order), {.domain = domain});
}

PictureLight randomPicture(std::size_t height, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<float> value(0, 2);
    PictureLight picture{.file = "", .width = 2 * height, .height = height, .rgb = {}};
    for (std::size_t k = 0; k < 6 * height * height; ++k) picture.rgb.push_back(value(random));
    return picture;
}

double largest(const std::vector<double>& values) {
    double most = 0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

void expectNear(const std::vector<double>& got, const std::vector<double>& expected,
                double tolerance) {
    ASSERT_EQ(got.size(), expected.size());
    const double scale = largest(expected);
    for (std::size_t k = 0; k < got.size(); ++k)
        ASSERT_NEAR(got[k], expected[k], tolerance * scale) << k;
}

/// Gauss by Gauss over each pixel, above the horizon of the frame; nodes clustered at its edges,
/// where functions may grow like a root.
std::vector<double> byPixels(const PictureLight& picture, const Basis& basis, const Frame& frame,
                             bool hemisphere, int nodes) {
    const auto slots = static_cast<std::size_t>(basis.slots());
    std::vector<double> sums(3 * slots, 0.0), values(slots);
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    const GaussRule& rule = gaussLegendre(nodes);
    const double pixel = pi / static_cast<double>(picture.height);
    for (std::size_t row = 0; row < picture.height; ++row) {
        for (std::size_t column = 0; column < picture.width; ++column) {
            const float* rgb = picture.rgb.data() + 3 * (row * picture.width + column);
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
                    const double down = pi / 2 * rule.nodes[i];
                    const double theta =
                        pixel * (static_cast<double>(row) + (1 + std::sin(down)) / 2);
                    const double phi =
                        pi - pixel * (static_cast<double>(column) + (1 + rule.nodes[j]) / 2) +
                        picture.turn;
                    const Direction d = frame.toLocal(directionFromAngles(theta, phi));
                    if (hemisphere && !(d.z > 0)) continue;
                    basis.evaluate(d, values.data());
                    const double weight = rule.weights[i] * rule.weights[j] * pixel * pixel / 4 *
                                          pi / 2 * std::cos(down) * std::sin(theta) *
                                          (projected ? d.z : 1);
                    for (std::size_t c = 0; c < 3; ++c)
                        for (std::size_t k = 0; k < slots; ++k)
                            sums[c * slots + k] += weight * rgb[c] * values[k];
                }
            }
        }
    }
    return sums;
}

/// 2 pi times the integral of P_l from cos r to 1.
double capIntegral(int l, double radius) {
    const double c = std::cos(radius);
    if (l == 0) return 2 * pi * (1 - c);
    return 2 * pi * (gsl_sf_legendre_Pl(l - 1, c) - gsl_sf_legendre_Pl(l + 1, c)) / (2 * l + 1);
}

TEST(LightProjection, DiscsAreDifferencesOfLegendrePolynomialsToOrderThousand) {
    const double theta = 0.9, phi = -2.2;
    for (const double radius : {0.05, 2.9}) {
        const DiscLight disc{directionFromAngles(theta, phi), radius, {1, 0.5, 2}};
        const LightCoefficients light = project({disc}, "sh", 1000);
        double scale = 0, worst = 0;
        for (int l = 0; l < 1000; ++l) {
            for (int m = -l; m <= l; m += std::max(1, l / 3)) {
                const int k = std::abs(m);
                const double azimuth = m == 0  ? 1
                                       : m > 0 ? std::sqrt(2) * std::cos(k * phi)
                                               : std::sqrt(2) * std::sin(k * phi);
                // GSL has the Condon-Shortley sign.
                const double sign = k % 2 == 0 ? 1 : -1;
                const double expected = sign * gsl_sf_legendre_sphPlm(l, k, std::cos(theta)) *
                                        azimuth * capIntegral(l, radius);
                scale = std::max(scale, std::abs(expected));
                worst = std::max(worst, std::abs(light.at(0)[slotOf(l, m)] - expected));
                EXPECT_EQ(light.at(2)[slotOf(l, m)], 2 * light.at(0)[slotOf(l, m)]);
            }
        }
        EXPECT_LT(worst, 1e-12 * scale) << radius;
        EXPECT_NEAR(light.energy.value, 5.25 * 2 * pi * (1 - std::cos(radius)), 1e-12);
        EXPECT_LT(light.error, 1e-12);
    }
}

TEST(LightProjection, SunsAreRelativelyExact) {
    // The difference of Legendre polynomials would lose 5 of 16 digits here: P_l is 1 - O(r^2).
    const double radius = radians(0.2665);
    const LightCoefficients light = project({DiscLight{{0, 0, 1}, radius, {1, 1, 1}}}, "sh", 12);
    for (int l = 0; l < 12; ++l) {
        // Series of P_l at 1: 1 - l (l + 1) / 2 (1 - x) + (l - 1) l (l + 1) (l + 2) / 16 (1 - x)^2
        const double y = 2 * std::pow(std::sin(radius / 2), 2), n = l * (l + 1.0);
        const double integral = y - n * y * y / 4 + n * (n - 2) * y * y * y / 48 -
                                n * (n - 2) * (n - 6) * y * y * y * y / 1152;
        const double expected = 2 * pi * integral * std::sqrt((2 * l + 1) / (4 * pi));
        EXPECT_NEAR(light.at(0)[slotOf(l, 0)] / expected, 1, 1e-13) << l;
    }
}

TEST(LightProjection, PicturesAreTheSumsOfTheirPixels) {
    for (const std::size_t height : {1, 2, 3, 5, 8}) {
        PictureLight picture = randomPicture(height, height);
        picture.turn = 0.3;
        const auto basis = bases::make("sh", 14);
        const LightCoefficients light = project({picture}, "sh", 14);
        expectNear(light.values, byPixels(picture, *basis, Frame({}), false, 44), 1e-13);
    }
}

TEST(LightProjection, PicturesStayExactToOrderThousand) {
    const PictureLight picture = randomPicture(6, 7);
    const int order = 1000;
    const auto basis = bases::make("sh", order);
    const LightCoefficients light = project({picture}, "sh", order);
    const GaussRule& rule = gaussLegendre(400);
    const double pixel = pi / 6, scale = largest(light.values);
    for (const int m : {0, 1, 2, 17, 400, 990}) {
        std::vector<double> cosine(1000, 0.0), sine(1000, 0.0);
        for (std::size_t row = 0; row < 6; ++row) {
            std::vector<Elevation<double>> points;
            for (const double x : rule.nodes) {
                const double theta = pixel * (static_cast<double>(row) + (1 + x) / 2);
                points.push_back({std::cos(theta), 2 * std::pow(std::sin(theta / 2), 2)});
            }
            std::vector<double> t(static_cast<std::size_t>(order - m) * points.size());
            basis->theta(m, points, t.data());
            double a = 0, b = 0;
            for (std::size_t column = 0; column < 12; ++column) {
                const double high = pi - pixel * static_cast<double>(column), low = high - pixel;
                const double value = picture.rgb[3 * (row * 12 + column)];
                const double norm = m == 0 ? 1 / std::sqrt(2 * pi) : 1 / std::sqrt(pi) / m;
                a += value * norm * (m == 0 ? pixel : std::sin(m * high) - std::sin(m * low));
                b += value * norm * (std::cos(m * low) - std::cos(m * high));
            }
            for (int l = m; l < order; ++l) {
                double integral = 0;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const double s = std::sqrt(points[i].oneMinusMu * (2 - points[i].oneMinusMu));
                    integral += rule.weights[i] * pixel / 2 * s *
                                t[static_cast<std::size_t>(l - m) * points.size() + i];
                }
                cosine[static_cast<std::size_t>(l)] += a * integral;
                sine[static_cast<std::size_t>(l)] += b * integral;
            }
        }
        double worst = 0;
        for (int l = m; l < order; ++l) {
            const auto k = static_cast<std::size_t>(l);
            worst = std::max(worst, std::abs(light.at(0)[slotOf(l, m)] - cosine[k]));
            if (m > 0) worst = std::max(worst, std::abs(light.at(0)[slotOf(l, -m)] - sine[k]));
        }
        EXPECT_LT(worst, 1e-12 * scale) << m;
    }
}

/// Coefficients of l, m of channel 0, pixel after pixel: azimuths in closed form, theta by Gauss.
double byRows(const std::vector<float>& rgb, std::size_t width, std::size_t height, int l, int m) {
    const auto basis = bases::make("sh", l + 1);
    const GaussRule& rule = gaussLegendre(l + 12);
    const double down = pi / static_cast<double>(height),
                 across = 2 * pi / static_cast<double>(width);
    const int k = std::abs(m);
    const double norm = k == 0 ? 1 / std::sqrt(2 * pi) : 1 / std::sqrt(pi) / k;
    double sum = 0;
    std::vector<double> t(static_cast<std::size_t>(l + 1 - k));
    for (std::size_t row = 0; row < height; ++row) {
        double azimuths = 0, integral = 0;
        for (std::size_t column = 0; column < width; ++column) {
            const double high = pi - across * static_cast<double>(column), low = high - across;
            azimuths += rgb[3 * (row * width + column)] * norm *
                        (m == 0  ? across
                         : m > 0 ? std::sin(k * high) - std::sin(k * low)
                                 : std::cos(k * low) - std::cos(k * high));
        }
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double theta = down * (static_cast<double>(row) + (1 + rule.nodes[i]) / 2);
            const std::vector<Elevation<double>> point{
                {std::cos(theta), 2 * std::pow(std::sin(theta / 2), 2)}};
            basis->theta(k, point, t.data());
            integral += rule.weights[i] * down / 2 * std::sin(theta) * t.back();
        }
        sum += azimuths * integral;
    }
    return sum;
}

// Low orders and widths of whole 32 have sums of their own; odd factors and lanes that are not all
// used; rows that are kept for a transform over theta, and those that are not.
TEST(LightProjection, FastTransformsAreSumsForAnySize) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(0, 2);
    struct Case {
        int order;
        std::size_t width, height;
    };
    for (const Case c : {Case{10, 64, 5},
                         {11, 160, 3},
                         {32, 32, 9},
                         {33, 32, 68},
                         {40, 33, 100},
                         {40, 96, 128},
                         {40, 20, 81},
                         {12, 31, 11}}) {
        std::vector<float> rgb(3 * c.width * c.height);
        for (float& each : rgb) each = value(random);
        LatlongProjection projection(c.order, c.width, c.height);
        projection.addRows(rgb.data(), 2);
        projection.addRows(rgb.data() + 6 * c.width, c.height - 2);
        const auto slots = static_cast<std::size_t>(c.order * c.order);
        std::vector<double> got(3 * slots);
        projection.coefficients(0, got.data());
        const int l = c.order - 1;
        for (const auto& [degree, m] : {std::pair{0, 0},
                                        {1, -1},
                                        {l, 0},
                                        {l, l},
                                        {l, -l},
                                        {l, 8},
                                        {l, -9},
                                        {l - 1, 3 - l},
                                        {l - 1, l - 2}})
            EXPECT_NEAR(got[slotOf(degree, m)], byRows(rgb, c.width, c.height, degree, m), 1e-13)
                << c.order << " " << c.width << " x " << c.height << ": " << degree << " " << m;
        double energy = 0;
        for (std::size_t row = 0; row < c.height; ++row) {
            const double solidAngle =
                (std::cos(pi * static_cast<double>(row) / static_cast<double>(c.height)) -
                 std::cos(pi * static_cast<double>(row + 1) / static_cast<double>(c.height))) *
                2 * pi / static_cast<double>(c.width);
            for (std::size_t column = 0; column < c.width; ++column)
                energy += solidAngle * std::pow(double{rgb[3 * (row * c.width + column)]}, 2);
        }
        EXPECT_NEAR(projection.energy()[0], energy, 1e-13 * energy);
    }
}

// Every instruction set has lanes of its own.
TEST(LightProjection, EveryInstructionSetGivesTheSameButForRounding) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> value(0, 2);
    for (const int order : {7, 25, 40}) {
        const std::size_t width = 96, height = 90;
        std::vector<float> rgb(3 * width * height);
        for (float& each : rgb) each = value(random);
        std::vector<double> first;
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            hwy::SetSupportedTargetsForTest(target);
            LatlongProjection projection(order, width, height);
            projection.addRows(rgb.data(), height);
            std::vector<double> got(static_cast<std::size_t>(3 * order * order));
            projection.coefficients(0.2, got.data());
            if (first.empty()) first = got;
            expectNear(got, first, 1e-14);
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}

TEST(LightProjection, WhiteIsOneCoefficient) {
    PictureLight picture{.file = "", .width = 20, .height = 10, .rgb = {}};
    picture.rgb.assign(600, 1.0F);
    SkyLight sky{.zenith = {1, 1, 1}, .ground = {1, 1, 1}};
    for (const Light& white : {Light(picture), Light(sky)}) {
        for (const int order : {1, 2, 10, 120}) {
            const LightCoefficients light = project({white}, "sh", order);
            EXPECT_NEAR(light.values[0], std::sqrt(4 * pi), 2e-13);
            EXPECT_NEAR(light.energy.value, 12 * pi, 1e-11);
            for (std::size_t k = 1; k < light.slots(); ++k)
                ASSERT_NEAR(light.values[k], 0, 2e-13) << order << " " << k;
            EXPECT_NEAR(light.curves[0].points.back().accuracy, 1, 1e-12);
        }
        for (const char* name : {"hsh", "zernike"}) {
            const LightCoefficients above = project({white}, name, 6, {.normal = tilted});
            EXPECT_NEAR(above.energy.value, 6 * pi, 1e-9);
            for (std::size_t k = 0; k < above.slots(); ++k)
                EXPECT_NEAR(above.values[k], k == 0 ? std::sqrt(2 * pi) : 0, 1e-7) << k;
        }
    }
}

TEST(LightProjection, HemispheresAreIntegralsOverTheirPartOfThePixels) {
    const PictureLight picture = randomPicture(4, 9);
    for (const char* name : {"hsh", "sh", "zernike", "makhotkin-flux"}) {
        const auto basis = bases::make(name, 6);
        // Rows of pixels end at this horizon.
        const LightCoefficients level = project({picture}, name, 6, {.normal = Orientation{}});
        expectNear(level.values, byPixels(picture, *basis, Frame({}), true, 40), 1e-7);
        const LightCoefficients light = project({picture}, name, 6, {.normal = tilted});
        const auto expected = byPixels(picture, *basis, Frame(tilted), true, 80);
        double difference = 0, all = 0;
        for (std::size_t k = 0; k < expected.size(); ++k) {
            difference += std::pow(light.values[k] - expected[k], 2);
            all += expected[k] * expected[k];
        }
        // The reference misses what its nodes at the horizon stand for.
        EXPECT_LT(std::sqrt(difference / all), 3e-3) << name;
        EXPECT_LT(light.error, 1e-5) << name;
    }
}

TEST(LightProjection, DiscsAboveTheHorizonAreTheSameByNodes) {
    const DiscLight disc{directionFromAngles(0.5, 1.3), 0.6, {1, 2, 3}};
    const LightCoefficients sphere = project({disc}, "sh", 20);
    const LightCoefficients level = project({disc}, "sh", 20, {.normal = Orientation{}});
    expectNear(level.values, sphere.values, 1e-10);
    EXPECT_LT(level.error, 1e-8);
}

TEST(LightProjection, IsLinearAndTurnsWithTheLight) {
    const PictureLight picture = randomPicture(5, 3);
    const DiscLight disc{directionFromAngles(1.1, 0.4), 0.3, {2, 1, 1}};
    const LightCoefficients one = project({picture}, "sh", 9), other = project({disc}, "sh", 9);
    std::vector<double> sum = one.values;
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += other.values[k];
    expectNear(project({picture, disc}, "sh", 9).values, sum, 1e-15);

    PictureLight turned = picture;
    turned.turn = 0.77;
    const LightCoefficients after = project({turned}, "sh", 9);
    std::vector<double> expected(sum.size());
    for (std::size_t c = 0; c < 3; ++c) {
        for (int l = 0; l < 9; ++l) {
            for (int m = 0; m <= l; ++m) {
                const double a = one.at(c)[slotOf(l, m)], b = one.at(c)[slotOf(l, -m)];
                const double cosine = std::cos(m * 0.77), sine = std::sin(m * 0.77);
                double* to = expected.data() + c * one.slots();
                to[slotOf(l, m)] = m == 0 ? a : cosine * a - sine * b;
                if (m > 0) to[slotOf(l, -m)] = sine * a + cosine * b;
            }
        }
    }
    expectNear(after.values, expected, 1e-14);
}

TEST(LightProjection, EnergyOfOverlappingLightsHasTheirProducts) {
    const double radius = 0.5, cap = 2 * pi * (1 - std::cos(radius));
    const DiscLight disc{directionFromAngles(0.9, 0.4), radius, {2, 2, 2}};
    const SkyLight sky{.zenith = {1, 1, 1}, .ground = {1, 1, 1}};
    PictureLight white{.file = "", .width = 8, .height = 4, .rgb = {}};
    white.rgb.assign(96, 1.0F);
    for (const Light& all : {Light(sky), Light(white)}) {
        const LightCoefficients light = project({disc, all}, "sh", 12);
        EXPECT_NEAR(light.energy.value, 3 * (4 * pi + (4 + 2 * 2) * cap), 1e-10);
        EXPECT_LT(light.curves[0].points.back().accuracy, 1);
    }
}

TEST(LightProjection, ResultsDoNotDependOnTheNumberOfThreads) {
    const std::vector<Light> lights{
        randomPicture(70, 1),
        SkyLight{.model = SkyLight::Model::overcast, .zenith = {1, 1, 1}, .ground = {.1, .1, .1}}};
    const auto with = [&](std::size_t threads, const LightDomain& domain) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return project(lights, "sh", 12, domain);
    };
    for (const LightDomain& domain : {LightDomain{}, LightDomain{.normal = tilted}}) {
        const LightCoefficients one = with(1, domain), two = with(2, domain);
        EXPECT_EQ(one.values, two.values);
        EXPECT_EQ(one.energy.value, two.energy.value);
    }
}

TEST(LightProjection, SphereIsForSphericalHarmonics) {
    EXPECT_THROW(project({SkyLight{}}, "hsh", 3), UsageError);
    EXPECT_THROW(project({}, "sh", 3), UsageError);
}

/// A cube's face as Gauss nodes in each of its n x n pixels: on the cube of half-size 1 with X to
/// the right, Y up, Z forward, a to the right and b down, the solid angle of da db is
/// (1 + a^2 + b^2)^(-3/2); the world has z up and looks along x.
void addFace(int face, const PictureLight& picture, std::size_t n, const Basis& basis,
             std::vector<double>& sums) {
    const GaussRule& rule = gaussLegendre(12);
    const auto slots = static_cast<std::size_t>(basis.slots());
    std::vector<double> values(slots);
    const double half = 1 / static_cast<double>(n);
    const auto rows = static_cast<std::size_t>(face) * n;
    for (std::size_t pixel = 0; pixel < n * n; ++pixel) {
        const std::size_t row = pixel / n, column = pixel % n;
        const float* rgb = picture.rgb.data() + 3 * ((rows + row) * n + column);
        for (std::size_t node = 0; node < 144; ++node) {
            const double a =
                half * (1 + 2 * static_cast<double>(column) + rule.nodes[node % 12]) - 1;
            const double b = half * (1 + 2 * static_cast<double>(row) + rule.nodes[node / 12]) - 1;
            const double places[6][3] = {{1, -b, -a}, {-1, -b, a}, {a, 1, b},
                                         {a, -1, -b}, {a, -b, 1},  {-a, -b, -1}};
            const double* at = places[face];
            const double length = std::sqrt(1 + a * a + b * b);
            const double weight = half * half * rule.weights[node % 12] * rule.weights[node / 12] /
                                  (length * length * length);
            basis.evaluate({at[2] / length, -at[0] / length, at[1] / length}, values.data());
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t k = 0; k < slots; ++k)
                    sums[c * slots + k] += weight * static_cast<double>(rgb[c]) * values[k];
        }
    }
}

// The solid angle within a pixel is not spread evenly: of a cube with 5 x 5 pixels a face, even
// shares miss coefficients by more than 1e-3.
TEST(LightProjection, StatedErrorsOfCubesHoldAgainstIntegralsOverTheirPixels) {
    std::mt19937_64 random(8);
    std::uniform_real_distribution<float> value(0, 2);
    for (const std::size_t n : {3, 5, 16}) {
        PictureLight picture{
            .file = "", .width = n, .height = 6 * n, .rgb = {}, .layout = PictureLayout::faces};
        for (std::size_t k = 0; k < 18 * n * n; ++k) picture.rgb.push_back(value(random));
        const auto basis = bases::make("sh", 5);
        std::vector<double> expected(75, 0.0);
        for (int face = 0; face < 6; ++face) addFace(face, picture, n, *basis, expected);
        const LightCoefficients found =
            projectLight(std::vector<Light>{picture}, *basis, {.domain = {}, .tolerance = 1e-9});
        double missed = 0, all = 0;
        for (std::size_t k = 0; k < expected.size(); ++k) {
            missed += std::pow(found.values[k] - expected[k], 2);
            all += expected[k] * expected[k];
        }
        EXPECT_LE(std::sqrt(missed / all), std::max(found.error, 1e-13)) << n;
        EXPECT_LE(found.error, 1e-6) << n;
    }
}

// The density of every layout has the solid angle of the pixel as its mean over it.
TEST(LightProjection, DensitiesIntegrateToSolidAngles) {
    const GaussRule& rule = gaussLegendre(20);
    const PictureGeometry geometries[] = {
        {PictureLayout::latlong, 20, 10},    {PictureLayout::angular, 11, 11},
        {PictureLayout::mirrorBall, 11, 11}, {PictureLayout::cross, 16, 12},
        {PictureLayout::cross, 12, 16},      {PictureLayout::faces, 5, 30}};
    for (const PictureGeometry& g : geometries) {
        for (std::size_t pixel = 0; pixel < g.width * g.height; ++pixel) {
            const std::size_t row = pixel / g.width, column = pixel % g.width;
            double sum = 0;
            bool whole = true;
            for (std::size_t k = 0; k < 400; ++k) {
                const double density =
                    g.density(static_cast<double>(column) + (1 + rule.nodes[k % 20]) / 2,
                              static_cast<double>(row) + (1 + rule.nodes[k / 20]) / 2);
                whole = whole && density > 0;
                sum += density * rule.weights[k % 20] * rule.weights[k / 20] / 4;
            }
            if (!whole) continue;  // beside the light, or on the rim of a disc
            EXPECT_NEAR(sum, g.solidAngle(column, row), 2e-3 * sum) << column << " " << row;
        }
    }
}

}  // namespace
