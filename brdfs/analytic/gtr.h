#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Microfacets (microfacet.h) distributed by the generalised Trowbridge-Reitz of Burley 2012,
/// "Physically-based shading at Disney", appendix B:
///     D = c / (alpha^2 cos^2 theta_h + sin^2 theta_h)^gamma,   alpha <= 1
///     c = (gamma - 1)(alpha^2 - 1)/(pi (1 - alpha^(2 - 2 gamma))), its limit for gamma = 1,
/// which makes the integral of D cos 1. gamma = 2 is GGX, 1 Berry; less has longer tails.
/// Burley leaves the masking open. Here it is Smith's for this D, which conserves energy as ggx
/// does. Lambda is tabulated over theta by quadrature of the distribution of slopes when the
/// model is made, to 1e-5 of Lambda (4e-6 at gamma = 10, 1e-7 up to 3).
const Model& gtrModel();

}  // namespace hshfit::brdfs
