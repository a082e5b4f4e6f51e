#pragma once

#include <brdfs/rows/writer.h>

namespace hshfit::brdfs {

/// The row of the table of writers: tabular BSDF data of Zemax (zemax.h), grey BRDFs.
///
/// `incidences` angles from 0 to `last` degrees, `azimuths` around the specular direction (half the
/// circle, as PlaneSymmetrical, for a mirror symmetric isotropic BRDF), and `radials` angles from
/// it, at (90 + last) (k / (n - 1))^2 degrees. `rotations` of the sample for an anisotropic BRDF,
/// as ASymmetrical4D. TIS is the directional reflectance. Below the horizon values are 0. Numbers
/// are the shortest that read back as the same double. Throws UsageError for RGB and spectral
/// BRDFs.
const Writer& zemaxWriter();

}  // namespace hshfit::brdfs
