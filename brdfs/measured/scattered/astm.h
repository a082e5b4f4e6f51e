#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Reads ASTM E1392 ("Standard Practice for Angle Resolved Optical Scatter Measurements"): lines of
/// a keyword and its value, up to
///     VARS theta_i,phi_i,theta_s,phi_s,NAME...
/// and rows of as many numbers, between commas. NUM_POINTS, where it is given, has to be right.
/// Angles are in radians (`inDegrees`: degrees) and may be negative; an azimuth that is not listed
/// is 0. Each other NAME is a channel of f in 1/sr: wavelengths ("400nm"), R,G,B or Red,Green,Blue
/// (and nothing else), or a single one of any name. Beside them, `sigma` (or `sigma_NAME` for each
/// channel) is the standard uncertainty of the values, and `scan` a number for the scan of a row.
/// Polar angles beyond 90 degrees are on the back (ASTM E2387): rows are reflections or
/// transmissions of light from the front or from the back, of which one is read (sides.h).
/// Throws InputError, with `where` and the line, for any other content.
Samples readAstm(std::string_view text, const std::string& where, bool inDegrees = false,
                 std::string_view side = "auto");

/// The row of the table of formats.
const Format& astmFormat();

}  // namespace hshfit::brdfs
