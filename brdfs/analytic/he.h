#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd / pi + ks F S |h|^4 / h.z^2 D / (pi cos_i cos_o),  h = wi + wo: the directional-diffuse
/// part of He, Torrance, Sillion & Greenberg 1991, 10.1145/127719.122738, for unpolarised light;
/// with the exponential that their Eq. 25 lacks (errata).
///     D  = (pi tau)^2 / 4 sum_{m >= 1} g^m exp(-g) / (m! m) exp(-(pi tau)^2 (h.x^2 + h.y^2) / m)
///     g  = (2 pi sigma h.z)^2
///     sigma^2 = sigma0^2 / (1 + W), W = W0((K_i + K_o)^2 / (8 pi)), the solution of Eq. 81 by
///          Lambert's W; K = tan(theta) erfc(a), a = tau cot(theta) / (2 sigma0)
///     S  = S_i S_o, S_i = (1 - erfc(a) / 2) / (1 + Lambda(a)), Smith's Lambda of Beckmann's slopes
/// sigma0, tau: RMS height and autocorrelation length, here in wavelengths (given values divided by
/// `wavelength`). |h|^4 / h.z^2 is the paper's factor G (Eq. 76), whose dot products are |h x k|.
/// F: exact, dielectric of index `ior`.
///
/// The mirror spike, a delta distribution with exp(-g) of the light, is left out, as in Ngan et al.
/// 2005: for sigma0 << 1 most of the energy is missing. The paper's uniform-diffuse part is kd.
/// For g >> 1 this is Beckmann's model of slope parameter 2 sigma / tau.
const Model& heModel();

/// sum_{m >= 1} g^(m - 1) exp(-g) / (m! m) exp(-b / m) for g, b >= 0, to 1e-12 of its value as long
/// as that exceeds 1e-280. The cost is at most 150 exponentials for any g.
double heSeries(double g, double b);

/// The principal branch of Lambert's W, W exp(W) = x, for x >= 0.
double lambertW(double x);

}  // namespace hshfit::brdfs
