#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Energy-preserving Oren-Nayar: Portsmouth, Kutz & Hill 2025, JCGT 14(1), "EON: A practical
/// energy-preserving rough diffuse BRDF" (arXiv 2410.18026); the base diffuse of OpenPBR.
///     f = kd/pi A (1 + r s/t) + kd'/pi (1 - E(cos_i))(1 - E(cos_o))/(1 - M)
///     s = wi.wo - cos_i cos_o,  t = max(cos_i, cos_o) if s > 0 else 1   (Fujii's Oren-Nayar, FON)
///     A = 1/(1 + (1/2 - 2/(3 pi)) r),  M = A (1 + (2/3 - 28/(15 pi)) r),
///     kd' = kd^2 M/(1 - kd (1 - M)),  E(c) = A (1 + r G(c)/pi)
///     G = S (theta - S c) + 2/3 (S/c (1 - S^3) - S),  S = sin theta        (albedo=exact)
/// albedo=approximate takes the paper's polynomial for G, whose albedo for kd = 1 is between
/// 0.9994 and 1.00015.
/// kd is the albedo of the single facet, r in [0, 1] the roughness; kd = 1 reflects exactly all.
/// Smooth but for the kink at s = 0 and where both heights are equal.
const Model& eonModel();

/// eon under OpenPBR Surface's names (ASWF, version 1.1): kd = base_weight base_color,
/// r = base_diffuse_roughness. The diffuse slab alone, without the attenuation by a specular layer.
const Model& openpbrDiffuseModel();

}  // namespace hshfit::brdfs
