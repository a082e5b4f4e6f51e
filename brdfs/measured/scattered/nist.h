#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads the rows of Mueller matrices that NIST publishes for sintered PTFE (Germer 2017,
/// 10.1364/AO.56.009333): a line of names, then
///     lambda, theta_i, phi_i, theta_r, phi_r, f_r11, m_12 ... m_44
/// with lambda in um, angles in degrees and f_r11 in 1/sr, the BRDF for unpolarised light; the
/// other 15 elements are relative to it. Every wavelength becomes a channel of each of `elements`;
/// pairs of directions that were not measured at all wavelengths are left out and counted. A
/// negative theta is on the other side of the normal. Throws InputError, with `where` and
/// the line, for any other content.
Samples readNist(std::string_view text, const std::string& where,
                 const MuellerElements& elements = MuellerElements());

/// The row of the table of formats.
const Format& nistFormat();

}  // namespace hshfit::brdfs
