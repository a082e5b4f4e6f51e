#pragma once

#include <hshfit/bases/basis.h>

#include <memory>

namespace hshfit::bases {

/// Real spherical harmonics: T_l^m = sqrt((2l+1)/2 (l-m)!/(l+m)!) P_l^m(mu), orthonormal over the
/// sphere. A function given on the hemisphere counts as 0 below the horizon.
std::unique_ptr<Basis> makeSh(int order, BasisOptions options);

/// Even spherical harmonics: sqrt(2) times the spherical harmonics with l + m even, orthonormal
/// over the hemisphere: the SH of a function that is mirrored at the horizon. n(n+1)/2 functions in
/// n bands.
std::unique_ptr<Basis> makeEsh(int order, BasisOptions options);

}  // namespace hshfit::bases
