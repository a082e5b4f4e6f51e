#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads the text form of Ansys Speos' surface files, "OPTIS - brdf surface file" (.brdf: a table
/// for each incidence and wavelength) and "OPTIS - Anisotropic BSDF surface file"
/// (.anisotropicbsdf: a table for each anisotropy angle and incidence, and a spectrum), by Ansys'
/// own description of their rows. Tables are over theta and phi of the outgoing direction in
/// degrees, phi counterclockwise from the specular side.
///
/// Values are in proportion to f (type 1) or to f cos(theta) (type 0), and percentages R give the
/// scale. With I = the integral of the bilinear table v cos(theta) (type 0: v) over the hemisphere,
///     f = R v / I            .brdf: R and I of the same table
///     f = R(lambda) v / I0   .anisotropicbsdf: I0 of the incidence at which R was measured, or
///                            weighted between its neighbours
/// and for type 0 divided by cos(theta). The anisotropy vector is the tangent +x: at an anisotropy
/// angle of p the light comes from azimuth 180 - p degrees. A spectrum of one percentage is grey.
///
/// Tables whose polar angles go from 90 to 180 degrees are of transmission, others of reflection,
/// in whatever order they come. `side`: "reflection-front", "transmission-front" or, by the user's
/// word, "transmission-back"; "auto": reflection, or transmission where there is no other. Entries
/// of 0 in all wavelengths are directions that were not measured, unless `zerosMeasured`. Throws
/// InputError, with `where` and the line, for other content and binary files.
Samples readSpeos(std::string_view text, const std::string& where, std::string_view side = "auto",
                  bool zerosMeasured = false);

/// The row of the table of formats.
const Format& speosFormat();

}  // namespace hshfit::brdfs
