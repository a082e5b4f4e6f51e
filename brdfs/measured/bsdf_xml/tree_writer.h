#pragma once

#include <brdfs/rows/writer.h>

namespace hshfit::brdfs {

/// Writes the reflection of a BRDF as a BSDF XML tensor tree, of rank 3 if it is isotropic and of
/// rank 4 if not: averages of f over pairs of cells of 2^levels steps along the square, by
/// projected solid angle. Branches whose values differ by no more than `prune`, relative to their
/// mean, become leaves with that mean. RGB and spectra become luminance. Throws as stated for
/// `Writer` (brdfs/rows/writer.h), and UsageError for more than 6 levels at rank 4.
const Writer& bsdfTreeWriter();

}  // namespace hshfit::brdfs
