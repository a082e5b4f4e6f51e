#include <hshfit/light/sky.h>

#include <hshfit/brdf/colour.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/light/internal/hosek_wilkie_sky.h>
#include <hshfit/light/light_samples.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::inline light {
namespace {

struct Gradation {
    double a, b;
};
struct Indicatrix {
    double c, d, e;
};
// Luminance towards the horizon, I to VI, and scattering around the sun, 1 to 6 (ISO 15469).
constexpr Gradation gradations[] = {{4, -.70},  {1.1, -.80}, {0, -1},
                                    {-1, -.55}, {-1, -.32},  {-1, -.15}};
constexpr Indicatrix indicatrices[] = {{0, -1, 0},    {2, -1.5, .15}, {5, -2.5, .30},
                                       {10, -3, .45}, {16, -3, .30},  {24, -2.8, .15}};

CieSky sky(int gradation, int indicatrix, std::string_view help) {
    const auto [a, b] = gradations[gradation - 1];
    const auto [c, d, e] = indicatrices[indicatrix - 1];
    return {help, {a, b, c, d, e, std::exp(d * (pi / 2))}};
}

/// F of a shape. `cosTheta` at least 0; `chi` in radians.
double shapeAt(const SkyShape& s, double cosTheta, double chi) {
    // exp(b / 0) is its limit: b < 0.
    const double gradation = 1 + (cosTheta > 0 ? s.a * std::exp(s.b / cosTheta) : 0);
    const double cosChi = std::cos(chi);
    return gradation * (1 + s.c * (std::exp(s.d * chi) - s.offset) + s.e * cosChi * cosChi);
}

double relativeTo(const SkyShape& shape, const Direction& sun, const Direction& world) {
    return shapeAt(shape, world.z, angleBetween(world, sun)) / shapeAt(shape, 1, polarAngle(sun));
}

/// The polynomial of a chromaticity at the zenith: rows by turbidity^2, ^1, ^0, columns by
/// sunTheta^3 to ^0.
double zenithChromaticity(const double (&m)[3][4], double turbidity, double sunTheta) {
    double sum = 0;
    for (const auto& row : m) {
        double inner = 0;
        for (const double value : row) inner = inner * sunTheta + value;
        sum = sum * turbidity + inner;
    }
    return sum;
}

constexpr double zenithX[3][4] = {{0.00166, -0.00375, 0.00209, 0},
                                  {-0.02903, 0.06377, -0.03202, 0.00394},
                                  {0.11693, -0.21196, 0.06052, 0.25886}};
constexpr double zenithY[3][4] = {{0.00275, -0.00610, 0.00317, 0},
                                  {-0.04214, 0.08970, -0.04153, 0.00516},
                                  {0.15346, -0.26756, 0.06670, 0.26688}};

/// The linear colour of luminance 1 and a chromaticity, scaled by `luminance`.
Rgb colourOf(double luminance, double x, double y) {
    return rec709FromXyz({luminance * x / y, luminance, luminance * (1 - x - y) / y});
}

}  // namespace

std::span<const CieSky> cieSkies() {
    static const CieSky table[] = {
        sky(1, 1, "overcast, steep gradation, the same in all azimuths"),
        sky(1, 2, "overcast, steep gradation, slightly brighter towards the sun"),
        sky(2, 1, "overcast, moderate gradation, the same in all azimuths"),
        sky(2, 2, "overcast, moderate gradation, slightly brighter towards the sun"),
        sky(3, 1, "uniform"),
        sky(3, 2, "partly cloudy, no gradation, slightly brighter towards the sun"),
        sky(3, 3, "partly cloudy, no gradation, brighter around the sun"),
        sky(3, 4, "partly cloudy, no gradation, distinct solar corona"),
        sky(4, 2, "partly cloudy, obscured sun"),
        sky(4, 3, "partly cloudy, brighter around the sun"),
        sky(4, 4, "white-blue sky, distinct solar corona"),
        sky(5, 4, "clear, low turbidity"),
        sky(5, 5, "clear, polluted atmosphere"),
        sky(6, 5, "cloudless turbid sky, broad solar corona"),
        sky(6, 6, "white-blue turbid sky, broad solar corona"),
    };
    return table;
}

SkyLight cieSky(int type, const Direction& sun, const Rgb& zenith) {
    assert(type >= 1 && type <= 15 && sun.z >= 0);
    SkyLight light{.model = SkyLight::Model::cie, .zenith = zenith, .sun = sun};
    light.shapes[0] = cieSkies()[static_cast<std::size_t>(type - 1)].shape;
    return light;
}

double preethamZenithLuminance(double turbidity, double sunTheta) {
    const double chi = (4.0 / 9 - turbidity / 120) * (pi - 2 * sunTheta);
    return (4.0453 * turbidity - 4.9710) * std::tan(chi) - 0.2155 * turbidity + 2.4192;
}

SkyLight preethamSky(double turbidity, const Direction& sun, const Rgb& scale) {
    assert(turbidity >= 2 && sun.z >= 0);
    const double t = turbidity, sunTheta = polarAngle(sun);
    SkyLight light{.model = SkyLight::Model::preetham, .zenith = scale, .sun = sun};
    for (double& value : light.zenith) value *= preethamZenithLuminance(turbidity, sunTheta);
    light.shapes[0] = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251,
                       0.1206 * t - 2.5771, -0.0670 * t + 0.3703};
    light.shapes[1] = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125,
                       -0.0641 * t - 0.8989, -0.0033 * t + 0.0452};
    light.shapes[2] = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102,
                       -0.0441 * t - 1.6537, -0.0109 * t + 0.0529};
    light.chromaticity = {zenithChromaticity(zenithX, t, sunTheta),
                          zenithChromaticity(zenithY, t, sunTheta)};
    return light;
}

Rgb radianceOf(const SkyLight& light, const Direction& world) {
    if (world.z < 0) return light.ground;
    Rgb radiance = light.zenith;
    const auto multiply = [&](double factor) {
        for (double& value : radiance) value *= std::max(factor, 0.0);
    };
    switch (light.model) {
        case SkyLight::Model::uniform:
            break;
        case SkyLight::Model::overcast:
            multiply((1 + 2 * world.z) / 3);
            break;
        case SkyLight::Model::cie:
            multiply(relativeTo(light.shapes[0], light.sun, world));
            break;
        case SkyLight::Model::preetham: {
            const auto relative = [&](std::size_t k) {
                return relativeTo(light.shapes[k], light.sun, world);
            };
            const Rgb colour = colourOf(relative(0), light.chromaticity[0] * relative(1),
                                        light.chromaticity[1] * relative(2));
            for (std::size_t c = 0; c < 3; ++c) radiance[c] *= std::max(colour[c], 0.0);
            break;
        }
        case SkyLight::Model::hosekWilkie: {
            const Rgb colour =
                hosekWilkieColour(*light.terms, world.z, angleBetween(world, light.sun));
            for (std::size_t c = 0; c < 3; ++c) radiance[c] *= colour[c];
        }
    }
    return radiance;
}

Rgb skyIrradiance(const SkyLight& light) {
    const Light one[] = {light};
    const LightSamples samples = sampleLights(one, Frame({}), 5);
    Rgb sum{};
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < samples.count(); ++k) {
            sum[c] += samples.flux[c][k] * samples.z[k];
        }
    }
    return sum;
}

}  // namespace hshfit::inline light
