#pragma once

#include <brdfs/rows/writer.h>

namespace hshfit::brdfs {

/// The row of the table of writers: ALTA text (alta.h), grey or RGB.
///
/// Scattered samples of pairs are kept as they are (`grid=samples`, the default for them). Any
/// other BRDF is sampled on the stated grid (`grid=angles`): `theta` polar angles from 0 to `last`
/// degrees for each direction, and `phi` azimuths around the circle; half the circle for a mirror
/// symmetric isotropic BRDF. Isotropic BRDFs are written as ISOTROPIC_TL_TV_PROJ_DPHI, others as
/// SPHERICAL_TL_PL_TV_PV. Numbers are the shortest that read back as the same double.
/// Throws UsageError for a spectral BRDF: the format has no wavelengths.
const Writer& altaWriter();

}  // namespace hshfit::brdfs
