#pragma once

#include <hshfit/irradiance/irradiance.h>

namespace hshfit::inline irradiance {

/// Irradiance at a normal from bands 0 and 1 of radiance by the non-linear reconstruction of
/// Geomerics ("Reconstructing Diffuse Lighting from Spherical Harmonic Data", CEDEC 2015). By
/// channel, E / pi = r0 + r1 . n in two bands, s = |r1| / (2 r0), q = (1 + n . r1 / |r1|) / 2:
///     E / pi = r0 (a + (1 - a) (p + 1) q^p),  p = 1 + 2 s,  a = (1 - s) / (1 + s)
/// The mean over normals is exact, and the result is nowhere below 0. For parallel light, s = 1 and
/// E / pi = 4 r0 q^3. An s above 1 counts as 1. For r0 <= 0 the result is 0. Bands from 2 on are
/// ignored.
Rgb geomericsIrradiance(const NineRgb& radiance, const Direction& normal);

}  // namespace hshfit::inline irradiance
