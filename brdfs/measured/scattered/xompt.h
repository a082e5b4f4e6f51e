#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads a BRDF look-up table of ASAM OpenMATERIAL 3D (schema material_brdf_schema.json 1.0.0):
/// JSON whose brdf.lookupTable has rows of wavelength in m, incident polar angle, outgoing polar
/// angle, outgoing azimuth relative to the incident one, in radians, and f in 1/sr. Rows with null
/// are left out and counted, and so are pairs without a value at every wavelength. Throws
/// InputError, with `where` and the row, for any other content, among it tables of other kinds
/// (emp, optical, reflCoeff).
Samples readXompt(std::string_view text, const std::string& where);

/// The row of the table of formats.
const Format& xomptFormat();

}  // namespace hshfit::brdfs
