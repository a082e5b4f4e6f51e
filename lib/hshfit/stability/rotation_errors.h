#pragma once

#include <hshfit/stability/basis_errors.h>

namespace hshfit::stability {

/// The growth of rounding through rotations of spherical harmonics in double precision: by degree,
/// the largest |R2 (R1 c) - (R2 R1) c| over the norm of the band, over rotations that are tilted a
/// little, by a right angle and any way, and a vector c with a fixed seed. `order` up to 1000.
DegreeErrors rotationErrors(int order);

}  // namespace hshfit::stability
