#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd / pi + ks max(0, Cx xi xo + Cy yi yo + Cz zi zo)^exponent: one generalised cosine lobe.
/// Lafortune, Foo, Torrance & Greenberg 1997, 10.1145/258734.258801.
///
/// normalized=true: C is divided by its largest component and the lobe scaled by (exponent + 2) /
/// (2 pi), so that its albedo is at most ks. Ngan et al. 2005 fitted this form.
///
/// Cx = Cy = -1, Cz = 1 is Phong's lobe; Cz < |Cx| leans it towards grazing (off-specular peaks),
/// Cx > 0 makes it retroreflective, Cx != Cy anisotropic. Values beyond the largest double (|C|
/// > 1 and a large exponent) are cut to it.
const Model& lafortuneModel();

}  // namespace hshfit::brdfs
