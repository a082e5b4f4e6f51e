#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Microfacets (microfacet.h) with Gaussian slopes (Beckmann & Spizzichino 1963), as in
/// Walter, Marschner, Li & Torrance 2007, 10.2312/EGWR/EGSR07/195-206:
///     D = exp(-(tx/ax)^2 - (ty/ay)^2) / (pi ax ay cos^4 theta_h),   tx, ty: slopes of h
///     Lambda = (erf(a) - 1) / 2 + exp(-a^2) / (2 a sqrt(pi)),  a = z / sqrt((ax x)^2 + (ay y)^2)
/// with erf itself, not the rational fit of that paper.
const Model& beckmannModel();

}  // namespace hshfit::brdfs
