#pragma once

#include <hshfit/representation/representation.h>
#include <hshfit/transfer/windows.h>

namespace hshfit::inline representation::inline constraints {

/// Each returns the changed coefficients and adds a step with its cost. For the kinds outgoing and
/// basis, neither factored nor quantised; UsageError for halfway.

/// Multiplies each band by its factor (`windowFactors`); kind basis: by the factors of both bands,
/// l for wi and k for wo. Bending minimises |f - f'|^2 + lambda |Delta f'|^2 with one lambda for
/// all outgoing directions and channels, such that |Delta f'|^2 is half of |Delta f|^2. -l (l + 1)
/// is the eigenvalue of the Laplacian Delta for sh, esh and lsosh; for hsh it is that on the sphere
/// to which the hemisphere is stretched by cos theta' = 2 cos theta - 1; for the other bases it is
/// a penalty that grows in the same way.
Representation windowed(Representation representation, Window window);
/// The coefficients nearest in L2 (for sh: over the sphere) with q >= -1e-5 of its root mean
/// square, over wi in the hemisphere, for each stored wo (kind basis: over both). A quadratic
/// program by Goldfarb & Idnani's dual method (1983), with directions as constraints that
/// are added where the result is still negative: local minima on a grid of 8, at last 24 nodes
/// per shortest wavelength, refined. Bilinear lookups between stored directions keep it.
/// `added`: q + added >= 0 instead, for a BRDF that the reconstruction adds; between stored
/// directions that holds if `added` does not depend on wo.
/// Throws UsageError for lsosh of an order with condition above 1e9, and NumericError where the
/// program does not end.
Representation madeNonNegative(Representation representation, const Brdf* added = nullptr);
/// The coefficients nearest in L2 whose directional albedo
///     a(wo) = integral of f(wi, wo) cos(theta_i) d omega_i,
/// from the moments of the basis functions, is nowhere above the albedo of `source`, the BRDF that
/// was projected, nor above 1 if that conserves energy: at the stored directions and, interpolated,
/// halfway between them; kind basis: at nodes over the hemisphere, 8 per shortest wavelength. For
/// one direction by itself a projection on a half-space. Coefficients that were non-negative stay
/// non-negative.
Representation madeEnergyPreserving(Representation representation, const Brdf& source);

}  // namespace hshfit::inline representation::inline constraints
