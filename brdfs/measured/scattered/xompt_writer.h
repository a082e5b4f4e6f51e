#pragma once

#include <brdfs/rows/writer.h>

namespace hshfit::brdfs {

/// The row of the table of writers: BRDF look-up tables of OpenMATERIAL (xompt.h), isotropic, grey
/// or spectral BRDFs. A grey one is for the `wavelength` in nm.
///
/// `theta` polar angles from 0 to `last` degrees for each direction, and `phi` azimuths around the
/// circle. Rows ascend by column as the schema asks, angles are rounded to its six decimals. The
/// licence and the authors are `license` and `author`; the schema requires them, and without an
/// option they are said to be unknown. Throws UsageError for RGB and anisotropic BRDFs.
const Writer& xomptWriter();

}  // namespace hshfit::brdfs
