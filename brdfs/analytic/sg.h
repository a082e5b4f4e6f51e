#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Spherical Gaussian lobe, Wang, Ren, Gong, Snyder & Guo 2009, 10.1145/1618452.1618479:
///     f = kd/pi + ks N exp(lambda (c - 1)),  lambda: sharpness,
///     axis=mirror  c = cosine of wi to the mirror direction of wo, N = n,
///     axis=normal  c = cosine of the half vector to the normal,    N = n/4,
/// where n = 1, or with normalized=true lambda/(2 pi (1 - exp(-2 lambda))), which makes the
/// integral of the Gaussian over its whole sphere 1 (1/4 is the least d omega_h / d omega_i).
/// Then the lobe's albedo is at most ks, and near it for sharp lobes far from grazing. Several
/// lobes: a sum, "sg:… + sg:…". No Fresnel effect and no masking; the tails fall as a Gaussian.
const Model& sgModel();

}  // namespace hshfit::brdfs
