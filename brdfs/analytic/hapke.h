#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Regolith and powders: Hapke 1981, "Bidirectional reflectance spectroscopy 1. Theory",
/// 10.1029/JB086iB04p03039, the isotropic multiple-scattering approximation for a smooth surface.
/// The BRDF is his bidirectional reflectance over cos_i, with the phase angle g between wi and wo:
///     f = ks w / (4 pi (cos_i + cos_o)) ([1 + B(g)] P(g) + H(cos_i) H(cos_o) - 1)
///     B(g) = B0 / (1 + tan(g/2) / h)                                     the opposition surge
///     P(g) = (1 + c)/2 q(b) + (1 - c)/2 q(-b),  q(b) = (1 - b^2) / (1 - 2 b cos g + b^2)^(3/2)
///     H(x) = (1 + 2x) / (1 + 2 gamma x),  gamma = sqrt(1 - w)            h-function=1981
///     H(x) = 1 / (1 - w x (r0 + (1 - 2 r0 x)/2 ln(1 + 1/x))),  r0 = (1 - gamma)/(1 + gamma)
///                                     h-function=2002: Hapke 2002, 10.1006/icar.2002.6853
/// w is the single-scattering albedo, b > 0 the width and c the direction of the phase function:
/// back for c > 0. The roughness of the surface (theta-bar) is left out. The H of 1981 errs by up
/// to 4 %, the H of 2002 by less than 1 %.
const Model& hapkeModel();

}  // namespace hshfit::brdfs
