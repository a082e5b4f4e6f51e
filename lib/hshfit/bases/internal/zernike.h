#pragma once

#include <hshfit/bases/basis.h>

#include <memory>

namespace hshfit::bases {

/// Hemispherical Zernike functions (Koenderink et al. 1996): T_q^m = sqrt(q+1) R_q^m(rho) with
/// rho = sqrt(1 - mu) = sqrt(2) sin(theta/2), q - m even; band l = q. Orthonormal over the
/// hemisphere, d omega. n(n+1)/2 functions in n bands.
std::unique_ptr<Basis> makeZernike(int order, BasisOptions options);

}  // namespace hshfit::bases
