#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd / pi + ks F D G / (N cos_i cos_o). Cook & Torrance 1982, 10.1145/357290.357293.
///     D = exp(-(tan theta_h / m)^2) / (m^2 cos^4 theta_h)                    (Beckmann)
///     G = min(1, 2 h.z cos_o / (h.wo), 2 h.z cos_i / (h.wo))                 (V-shaped grooves)
///     F = exact Fresnel reflectance of a dielectric whose index gives F0 at normal incidence:
///         eta = (1 + sqrt F0) / (1 - sqrt F0), F0 = ((eta - 1) / (eta + 1))^2; `ior` gives eta
///         itself; fresnel=schlick: Schlick's approximation; conductor: exact for ior + i k
///     N = pi (norm=pi), as printed, or 4 pi (norm=4), with which D / pi is a normalised
///     distribution and the albedo at most kd + ks. As printed the lobe is four times as bright.
///     pi^2 (norm=pi2): the printed 1 / pi with a normalised D, as Ngan et al. fitted it in 2005.
const Model& cookTorranceModel();

}  // namespace hshfit::brdfs
