#pragma once

#include <hshfit/brdf/brdf.h>

namespace hshfit::inline accuracy {

/// Variation of f at normal incidence with the azimuth of wo; an isotropic f has none: the root
/// mean square of its deviations from its mean over 24 azimuths, relative to that mean, the largest
/// over theta_o = 15, 30, 45, 60 and 75 degrees. Channels are summed. 0 where f is 0 or not finite.
double azimuthVariation(const Brdf& brdf);

}  // namespace hshfit::inline accuracy
