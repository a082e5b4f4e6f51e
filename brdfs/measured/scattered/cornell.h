#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads a goniometer file of Cornell University's Program of Computer Graphics: comments (#), the
/// number of wavelengths, that many wavelengths in nm, ascending, and rows
///     theta_i phi_i theta_s phi_s f[wavelength]...
/// in radians and 1/sr. Both directions point away from the surface: the mirror direction is at
/// phi_s = phi_i + pi. Throws InputError, with `where` and the line, for any other content.
Samples readCornell(std::string_view text, const std::string& where);

/// The row of the table of formats.
const Format& cornellFormat();

}  // namespace hshfit::brdfs
