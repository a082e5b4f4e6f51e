#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Transmission through a rough boundary of a dielectric, over the two opposite hemispheres:
/// Walter, Marschner, Li & Torrance 2007, 10.2312/EGWR/EGSR07/195-206, Eq. 21:
///     f_t = kt |i.h| |o.h| / (|i.n| |o.n|) n_o^2 (1 - F(i, h)) G D(h) / (n_i i.h + n_o o.h)^2
///     h = -(n_i i + n_o o), made 1 long, towards +z,   F: dielectric,   G = G_1(i) G_1(o)
/// with D and G_1 of GGX (Eq. 33, 34) or Beckmann (Eq. 25, with erf itself for G_1 and not the
/// rational fit of Eq. 27). transmission-front: n_i = 1, n_o = ior; transmission-back: the reverse.
/// The share of light that comes through, the integral of f_t cos(theta_o) over wo, is the Fresnel
/// transmittance T in the smooth limit; radiance under uniform light is (n_o / n_i)^2 T.
/// Light that meets several facets is left out.
const Model& roughGlassModel();

}  // namespace hshfit::brdfs
