#pragma once

#include <hshfit/bases/basis.h>

#include <memory>

namespace hshfit::bases {

/// Hemispherical harmonics (Gautron et al. 2004, Eqs. 5-7):
///     T_l^m = sqrt((2l+1) (l-m)!/(l+m)!) P_l^m(2 mu - 1),
/// orthonormal over the hemisphere, d omega. Every function with m > 0 is 0 at the horizon.
std::unique_ptr<Basis> makeHsh(int order, BasisOptions options);

}  // namespace hshfit::bases
