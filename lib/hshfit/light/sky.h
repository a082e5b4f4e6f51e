#pragma once

#include <hshfit/light/lights.h>

#include <span>
#include <string_view>

namespace hshfit::inline light {

/// One of the standard general skies of the CIE (ISO 15469:2004, CIE S 011/E:2003).
struct CieSky {
    std::string_view help;
    SkyShape shape;
};

/// Types 1 to 15 at indices 0 to 14.
std::span<const CieSky> cieSkies();

/// The sky of `type`, 1 to 15, with the sun in direction `sun`, whose z must not be below 0, and
/// radiance `zenith` at the zenith.
SkyLight cieSky(int type, const Direction& sun, const Rgb& zenith);

/// The daylight sky of Preetham, Shirley and Smits 1999 ("A Practical Analytic Model for Daylight",
/// appendix A.2) without the disc of the sun. `turbidity` from 2 (clear) to 10 (haze); the authors
/// fitted 2 to 6. `zenith` is 1 for a luminance in their unit, 1000 cd/m^2 = 1.
SkyLight preethamSky(double turbidity, const Direction& sun, const Rgb& scale);

/// Luminance of Preetham's zenith in 1000 cd/m^2, sun at `sunTheta` radians from the zenith.
double preethamZenithLuminance(double turbidity, double sunTheta);

/// Radiance in a direction; the ground's for world.z < 0.
Rgb radianceOf(const SkyLight& light, const Direction& world);

/// Irradiance of a horizontal surface, by quadrature to a relative error of 1e-6.
Rgb skyIrradiance(const SkyLight& light);

}  // namespace hshfit::inline light
