#pragma once

#include <brdfs/rows/writer.h>

namespace hshfit::brdfs {

/// Writes the reflection of a BRDF as a BSDF XML matrix over the 145 patches of LBNL/Klems Full:
/// averages of f over pairs of patches by projected solid angle (averageOverCells), so that the sum
/// over outgoing patches is the reflectance of an incident patch. RGB and spectra become luminance.
/// Throws as stated for `Writer` (brdfs/rows/writer.h).
const Writer& bsdfKlemsWriter();

}  // namespace hshfit::brdfs
