#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd / pi + ks F D G1(theta_i) G1(theta_o) / (pi cos_i cos_o), every parameter per channel.
/// Bagher, Soler & Holzschuch 2012, 10.1111/j.1467-8659.2012.03147.x: shifted gamma distribution.
///     D  = K exp(-u) / u^p / (pi cos(theta_h)^4),  u = alpha + tan(theta_h)^2 / alpha
///     F  = F0 - F1 c + (1 - F0)(1 - c)^5, c = (h.wo); F1 = 0 is Schlick's. Below 0 it is cut to 0
///     G1 = 1 + Lambda (1 - exp(c (theta - theta0)^k)) for theta > theta0, else 1; cut to [0, 1]
/// Angles in radians. The default of K is 1 / (alpha Gamma(1 - p, alpha)), which makes D
/// cos(theta_h) integrate to 1. Lambda = 0 means no masking. The paper fits Lambda, c, k and
/// theta0 to the masking that D implies. F0 and F1 are free there, so that fitted values go far
/// beyond the reflectances of a surface.
/// p = 0 is a Gaussian of slopes t; p > 0 a power law t^(-2 p) from t = alpha to sqrt(alpha).
const Model& sgdModel();

}  // namespace hshfit::brdfs
