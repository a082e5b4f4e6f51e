#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Microfacets (microfacet.h) with slopes distributed as Trowbridge & Reitz 1975, GGX in
/// Walter, Marschner, Li & Torrance 2007, 10.2312/EGWR/EGSR07/195-206:
///     D = 1 / (pi ax ay cos^4 theta_h (1 + (tx/ax)^2 + (ty/ay)^2)^2),   tx, ty: slopes of h
///     Lambda = (sqrt(1 + (ax x)^2/z^2 + (ay y)^2/z^2) - 1) / 2
/// alpha is GGX's own width parameter, not the squared "roughness" of shading languages.
/// The tails fall as slope^-4: the lobe needs many more coefficients than Beckmann's.
const Model& ggxModel();

}  // namespace hshfit::brdfs
