#pragma once

#include <hshfit/bases/basis.h>

#include <memory>

namespace hshfit::bases {

/// Makhotkin's functions, reconstructed (the original, Makhotkin 1996, was not consulted): the
/// shifted associated Jacobi polynomials
///     M_l^m = sqrt((2l+2)(l-m)!(l+m+1)!/(l!(l+1)!)) [mu(1-mu)]^{m/2} P_{l-m}^{(m,m+1)}(2 mu - 1)
/// up to a constant that depends on m only, orthonormal over the hemisphere, cos(theta) d omega.
/// c_00 sqrt(pi) is the irradiance; no other function carries flux.
std::unique_ptr<Basis> makeMakhotkinFlux(int order, BasisOptions options);

/// sqrt(mu) times the same, orthonormal over the hemisphere, d omega.
std::unique_ptr<Basis> makeMakhotkin(int order, BasisOptions options);

}  // namespace hshfit::bases
