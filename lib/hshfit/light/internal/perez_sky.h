#pragma once

#include <hshfit/light/lights.h>

namespace hshfit::inline light {

/// A sky by two measured numbers (Perez, Seals & Michalsky 1993, "All-weather model for sky
/// luminance distribution", Solar Energy 50(3)). With Z the angle of the sun from the zenith in
/// radians, I the irradiance of the sun across its beam, D the irradiance of a horizontal surface
/// by the sky and E0 the irradiance of the sun outside of the atmosphere, all in one unit:
///     clearness  = ((D + I) / D + 1.041 Z^3) / (1 + 1.041 Z^3)
///     brightness = m D / E0,  m = 1 / (cos Z + 0.15 (93.885 - Z in degrees)^-1.253)
struct PerezWeather {
    double clearness = 1, brightness = 0.1;
};
PerezWeather perezWeather(const Direction& sun, double direct, double diffuse,
                          double extraterrestrial);

/// The coefficients a to e of the paper's table 1, with the authors' bounds of the brightness: at
/// least 0.2 for a clearness between 1.065 and 2.8, and 0.01 to 0.6.
SkyShape perezShape(const PerezWeather& weather, const Direction& sun);

/// The sky of the model with irradiance `diffuse` of a horizontal surface, without the sun's disc.
/// Throws InputError where the fitted coefficients leave a sky that is below 0 at the zenith or
/// infinite at the horizon.
SkyLight perezSky(const Direction& sun, double direct, double diffuse, double extraterrestrial);

}  // namespace hshfit::inline light
