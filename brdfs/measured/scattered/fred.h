#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads tabulated scatter data of FRED (Photon Engineering): the lines
///     type bsdf_data
///     format angles=deg|rad bsdf=value scale=1
/// then, for each incidence, a line `theta_i phi_i` of the specular direction and rows `theta_s
/// phi_s f`, both about the normal. Light comes from the direction opposite in azimuth. Values are
/// f over X, in 1/sr. Rows with theta_s past 90 degrees are transmission; they are left out and
/// counted. Throws InputError, with `where` and the line, for any other content.
Samples readFred(std::string_view text, const std::string& where);

/// The row of the table of formats.
const Format& fredFormat();

}  // namespace hshfit::brdfs
