#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Scatter from the roughness of a polished surface, D as in abg.h:
///     generalised  f = kd / pi + b0 ((cos_i + cos_o) / 2)^2 (1 + (|D| / l)^2)^(s / 2)
///     classic      f = kd / pi + b0 (1 + (|D| / l)^2)^(s / 2)
/// classic: Harvey 1976, "Light-scattering characteristics of optical surfaces", the
/// shift-invariant lobe of the Harvey-Shack theory. generalised: the smooth-surface limit of
/// Krywonos, Harvey & Choi 2011, 10.1364/JOSAA.28.001121, f = (4 pi^2 / lambda^4) (cos_i + cos_o)^2
/// Q S(D / lambda), with the K-correlation spectrum S(x) = A / (1 + (B x)^2)^(C / 2):
///     b0 = 16 pi^2 Q A / lambda^4,   l = lambda / B,   s = -C
/// At equal polar angles it is Rayleigh and Rice's. Valid for heights sigma far below the
/// wavelength, (4 pi sigma cos / lambda)^2 << 1; the mirror spike is left out.
const Model& harveyShackModel();

}  // namespace hshfit::brdfs
