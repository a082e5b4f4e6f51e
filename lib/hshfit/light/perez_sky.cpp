#include <hshfit/light/internal/perez_sky.h>

#include <hshfit/error.h>
#include <hshfit/light/sky.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

/// Factors of 1, Z, brightness and brightness Z, for a, b, c, d, e.
struct Row {
    double below;  ///< the clearness at which the next row begins
    double factors[5][4];
};

// Table 1 of the paper.
constexpr Row table[] = {
    {1.065,
     {{1.3525, -0.2576, -0.2690, -1.4366},
      {-0.7670, 0.0007, 1.2734, -0.1233},
      {2.8000, 0.6004, 1.2375, 1.0000},
      {1.8734, 0.6297, 0.9738, 0.2809},
      {0.0356, -0.1246, -0.5718, 0.9938}}},
    {1.230,
     {{-1.2219, -0.7730, 1.4148, 1.1016},
      {-0.2054, 0.0367, -3.9128, 0.9156},
      {6.9750, 0.1774, 6.4477, -0.1239},
      {-1.5798, -0.5081, -1.7812, 0.1080},
      {0.2624, 0.0672, -0.2190, -0.4285}}},
    {1.500,
     {{-1.1000, -0.2515, 0.8952, 0.0156},
      {0.2782, -0.1812, -4.5000, 1.1766},
      {24.7219, -13.0812, -37.7000, 34.8438},
      {-5.0000, 1.5218, 3.9229, -2.6204},
      {-0.0156, 0.1597, 0.4199, -0.5562}}},
    {1.950,
     {{-0.5484, -0.6654, -0.2672, 0.7117},
      {0.7234, -0.6219, -5.6812, 2.6297},
      {33.3389, -18.3000, -62.2500, 52.0781},
      {-3.5000, 0.0016, 1.1477, 0.1062},
      {0.4659, -0.3296, -0.0876, -0.0329}}},
    {2.800,
     {{-0.6000, -0.3566, -2.5000, 2.3250},
      {0.2937, 0.0496, -5.6812, 1.8415},
      {21.0000, -4.7656, -21.5906, 7.2492},
      {-3.5000, -0.1554, 1.4062, 0.3988},
      {0.0032, 0.0766, -0.0656, -0.1294}}},
    {4.500,
     {{-1.0156, -0.3670, 1.0078, 1.4051},
      {0.2875, -0.5328, -3.8500, 3.3750},
      {14.0000, -0.9999, -7.1406, 7.5469},
      {-3.4000, -0.1078, -1.0750, 1.5702},
      {-0.0672, 0.4016, 0.3017, -0.4844}}},
    {6.200,
     {{-1.0000, 0.0211, 0.5025, -0.5119},
      {-0.3000, 0.1922, 0.7023, -1.6317},
      {19.0000, -5.0000, 1.2438, -1.9094},
      {-4.0000, 0.0250, 0.3844, 0.2656},
      {1.0468, -0.3788, -2.4517, 1.4656}}},
    {1e300,
     {{-1.0500, 0.0289, 0.4260, 0.3590},
      {-0.3250, 0.1156, 0.7781, 0.0025},
      {31.0625, -14.5000, -46.1148, 55.3750},
      {-7.2312, 0.4050, 13.3500, 0.6234},
      {1.5000, -0.6426, 1.8564, 0.5636}}},
};

}  // namespace

PerezWeather perezWeather(const Direction& sun, double direct, double diffuse,
                          double extraterrestrial) {
    const double z = polarAngle(sun), cubic = 1.041 * z * z * z;
    const double mass = 1 / (std::cos(z) + 0.15 * std::pow(93.885 - degrees(z), -1.253));
    return {.clearness = ((diffuse + direct) / diffuse + cubic) / (1 + cubic),
            .brightness = mass * diffuse / extraterrestrial};
}

SkyShape perezShape(const PerezWeather& weather, const Direction& sun) {
    const double z = polarAngle(sun);
    const bool between = weather.clearness > 1.065 && weather.clearness < 2.8;
    const double delta = std::clamp(weather.brightness, between ? 0.2 : 0.01, 0.6);
    const Row* row = table;
    while (weather.clearness >= row->below) ++row;
    double x[5];
    for (std::size_t k = 0; k < 5; ++k) {
        const double(&f)[4] = row->factors[k];
        x[k] = f[0] + f[1] * z + delta * (f[2] + f[3] * z);
    }
    if (row == table) {
        const double(&c)[4] = row->factors[2];
        const double(&d)[4] = row->factors[3];
        x[2] = std::exp(std::pow(delta * (c[0] + c[1] * z), c[2])) - c[3];
        x[3] = -std::exp(delta * (d[0] + d[1] * z)) + d[2] + delta * d[3];
    }
    return {x[0], x[1], x[2], x[3], x[4], 0};
}

SkyLight perezSky(const Direction& sun, double direct, double diffuse, double extraterrestrial) {
    const PerezWeather weather = perezWeather(sun, direct, diffuse, extraterrestrial);
    SkyLight sky{.model = SkyLight::Model::cie, .zenith = {1, 1, 1}, .sun = sun};
    sky.shapes[0] = perezShape(weather, sun);
    const SkyShape& s = sky.shapes[0];
    const double chi = polarAngle(sun);
    const double zenith = (1 + s.a * std::exp(s.b)) *
                          (1 + s.c * std::exp(s.d * chi) + s.e * std::pow(std::cos(chi), 2));
    if (s.b >= 0 || !(zenith > 0))
        throw InputError(fmt::format(
            "perez: no sky of the model has clearness {:.4g} and brightness {:.4g} with the sun "
            "{:.4g} degrees from the zenith; its coefficients leave a sky that is {}",
            weather.clearness, weather.brightness, degrees(chi),
            s.b >= 0 ? "infinite at the horizon" : "below 0 at the zenith"));
    const Rgb one = skyIrradiance(sky);
    for (std::size_t c = 0; c < 3; ++c) sky.zenith[c] = diffuse / one[c];
    return sky;
}

}  // namespace hshfit::inline light
