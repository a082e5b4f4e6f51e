#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Sheen of cloth: Estevez & Kulla 2017, "Production friendly microfacet sheen BRDF", Sony Pictures
/// Imageworks.
///     f = ks D/(4 cos_i cos_o (1 + Lambda_i + Lambda_o)),  D = (2 + 1/r) sin^(1/r) theta_h/(2 pi)
///     Lambda = exp(L(cos)) below cos = 1/2, exp(2 L(1/2) - L(1 - cos)) above
///     L(x) = a/(1 + b x^c) + d x + e, the five mixed from their table by (1 - r)^2
/// Lambda is the authors' fit to Smith's masking of D, not that masking itself. terminator=soft
/// raises the Lambda of wi to the power 1 + 2 (1 - cos_i)^8, which softens the terminator as in the
/// paper and loses reciprocity. Fresnel is 1 in both: ks is the sheen colour. The model has neither
/// a base layer nor the authors' albedo scaling; a sum ("lambert:kd=.4 + charlie:r=.3") adds
/// energy.
const Model& charlieModel();

}  // namespace hshfit::brdfs
