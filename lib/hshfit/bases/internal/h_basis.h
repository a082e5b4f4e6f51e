#pragma once

#include <hshfit/bases/basis.h>

#include <memory>

namespace hshfit::bases {

/// The six functions of Habel & Wimmer 2010 (10.1145/1730804.1730818), orthonormal over the
/// hemisphere, d omega, in the slots of the spherical harmonics that they resemble:
///     (0,0) 1/sqrt(2 pi);  (1,0) sqrt(3/2pi) (2 mu - 1);
///     (1,-1), (1,1) sqrt(3/2pi) sin(theta) {sin phi, cos phi};
///     (2,-2), (2,2) 1/2 sqrt(15/2pi) sin^2(theta) {sin 2phi, cos 2phi}.
/// Order at most 3. Not graded by degree: there is no (2, 0), (2, +-1).
std::unique_ptr<Basis> makeHBasis(int order, BasisOptions options);

}  // namespace hshfit::bases
