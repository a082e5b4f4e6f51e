#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/stability/basis_errors.h>

namespace hshfit::stability {

/// The growth of rounding through rotations of spherical harmonics, `order` up to 1000, by degree:
/// double  the largest |R2 (R1 c) - (R2 R1) c| over the norm of the band
/// float   |R c| of band matrices and coefficients in single precision against those in double,
///         over the norm of the band; degrees up to 20 and some above, NaN for the others
/// over rotations that are tilted a little, by a right angle and any way, and c with a fixed seed.
DegreeErrors rotationErrors(int order, Precision precision = Precision::twice);

/// The same for rotations of a basis of the hemisphere, whose matrix M(R) deletes what leaves
/// (hemisphere_rotation.h); `order` is at most 32, where matrices end.
/// double  the column norms of M(R) - M(R^-1)^T, which is 0 for a basis that is orthonormal over
///         solid angle: two quadratures, over the lune that stays and over its image
/// float   M(R) c in single precision against that in double, over the norm of the band of c
DegreeErrors hemisphereRotationErrors(const Basis& basis, Precision precision);

}  // namespace hshfit::stability
