#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/representation.h>

namespace hshfit::inline representation::inline halfway {

/// Rounds the coefficients of the halfway form of `brdf` to what `precision` holds, as `quantise`
/// does to each by itself, and lets the coefficients that are not rounded yet make up for the
/// change of the loss and of directional albedo: with v as fitted and q on the grid, q minimises
///     (q - v)^T H (q - v),   H = R^T R the normal equations of the fit at v,
/// coefficient by coefficient from the coarsest grid to the finest (nearest plane, Babai 1986). The
/// result has as many bytes as with `quantise`. float32 and float64 are rounded by themselves.
/// Throws as `quantise` does.
void quantiseHalfway(Representation& representation, Precision precision, const Brdf& brdf);

}  // namespace hshfit::inline representation::inline halfway
