#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd / pi + ks N cos(theta_h)^exponent, theta_h between the half vector and the normal.
/// N = 1, or (n + 2)(n + 4) / (8 pi (2^(-n/2) + n)) if normalized, the exact factor that makes ks
/// the albedo at normal incidence (n: exponent). The often quoted (n + 8) / (8 pi) exceeds it.
/// normalized=phong: N = (n + 2) / (2 pi), the factor of a lobe about the mirror direction, near
/// four times the exact one; Ngan et al. 2005 fitted with it.
///
/// Blinn 1977, 10.1145/563858.563893. No masking and no 1 / cos terms: the albedo falls towards
/// grazing. cos(theta_h) comes from the slope of wi + wo, so that exponents of 1e6 keep their
/// digits.
const Model& blinnPhongModel();

}  // namespace hshfit::brdfs
