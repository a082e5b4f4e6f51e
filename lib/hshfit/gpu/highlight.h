#pragma once

#include <hshfit/brdf/brdf.h>

namespace hshfit::gpu {

/// A GGX roughness about as wide as the highlight, 0.02 to 1, for sampling directions. It is the
/// roughness of the narrowest lobe that the BRDF names (Brdf::lobes). Without named lobes it is the
/// tan(theta_h) at which f, less its value at theta_h = 60 degrees, falls to a quarter of its peak,
/// as GGX's D does at tan(theta_h) = alpha; this is measured at theta_d = 20 degrees, across the
/// plane of incidence. 1 where there is no highlight.
double highlightRoughness(const Brdf& brdf);

}  // namespace hshfit::gpu
