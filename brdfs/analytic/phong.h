#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd / pi + ks N max(0, cos alpha)^exponent, alpha between wi and the mirror direction of wo.
/// N = 1, or (exponent + 2) / (2 pi) if normalized, which makes ks the albedo at normal incidence.
///
/// Phong 1975 (10.1145/360825.360839) gives reflected light, that is f cos(theta_i). The same
/// lobe as f, as in Lafortune & Willems 1994 (which has N), is reciprocal. The albedo
/// of a narrow lobe falls as cos(theta_o). cos alpha is 1 - |wi - mirror|^2 / 2, so that exponents
/// of 1e6 keep their digits.
const Model& phongModel();

}  // namespace hshfit::brdfs
