#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads scans of pab-opto's gonio-photometers as its program Mountain writes them, by the manual
/// of Radiance's pabopto2bsdf: lines of a header that begin with '#', then rows of theta, phi and a
/// value in degrees, between blanks or tabs.
///     #format: theta phi BSDF      f; BRDF and BTDF alike. DSF: f times the cosine of theta
///     #incident_angle THETA PHI    or #intheta THETA and #inphi PHI
///     #colorimetry: CIE-Y          one value; CIE-XYZ: three, which become RGB
///     #sample_name "NAME"
/// All other lines of the header are remarks. A file holds one incidence; files one after the
/// other, each with its header, are a scan of several. Polar angles up to 180 degrees are from the
/// front's normal: rows are reflections or transmissions of light from the front or from the back,
/// of which one is read (sides.h).
///
/// Throws InputError, with `where` and the line, for rows before a format and an incidence, and
/// other content.
Samples readPabOpto(std::string_view text, const std::string& where,
                    std::string_view side = "auto");

/// The row of the table of formats.
const Format& pabOptoFormat();

}  // namespace hshfit::brdfs
