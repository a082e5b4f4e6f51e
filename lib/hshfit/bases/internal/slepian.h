#pragma once

#include <hshfit/bases/basis.h>

#include <memory>

namespace hshfit::bases {

/// Hemispherical Slepian functions: of all combinations of spherical harmonics of degree below
/// 2 order with one m, those with the most of their energy on the upper hemisphere (Simons, Dahlen
/// & Wieczorek 2006, for a polar cap of 90 degrees). Function (l, m) is the (l - |m|)-th best of
/// its m, normalised over the hemisphere by 1 / sqrt(lambda); its share lambda of the energy is at
/// least one half, and 1 to rounding for most. Positive next to the pole; 0 below the horizon.
///
/// For each m the functions are the eigenvectors of a tridiagonal matrix that commutes with the
/// Gram matrix (Grünbaum 1982) and, unlike that, has well separated eigenvalues.
///
/// The band limit follows from the order: the functions of a lower order are others, not a prefix.
/// Order at most 100: tables cost order^4 operations, and theta parts a product of 2 order
/// harmonics for every function.
std::unique_ptr<Basis> makeSlepian(int order, BasisOptions options);

}  // namespace hshfit::bases
