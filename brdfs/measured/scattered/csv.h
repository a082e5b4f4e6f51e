#pragma once

#include <brdfs/measured/scattered/samples.h>
#include <brdfs/measured/scattered/table_columns.h>
#include <brdfs/rows/format.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// Answers to what a table leaves open. `unstated`, `none` and `automatic` take what the file says.
struct CsvOptions {
    AngleUnit angles = AngleUnit::unstated;
    StatedQuantity quantity = StatedQuantity::none;
    /// The side of signed viewing angles without azimuth that the mirror direction is on.
    enum class Forward { automatic, plus, minus } forward = Forward::automatic;
    /// A relative azimuth of 0 is on the side of the light, or of the mirror direction.
    enum class Azimuth { automatic, light, mirror } azimuth = Azimuth::automatic;
    bool zerosMeasured = true;  ///< samples that are 0 in every channel are values
};

/// Reads a table of samples with named columns (table_columns.h): lines of prose or comments ('#',
/// '%', '//'), the line of names, and rows with the same separator: tab, ';', ',' or blanks. With
/// tabs or ';' numbers may have decimal commas. Rows with an empty cell, NA or NaN among the values
/// are left out and counted.
///
/// Both directions point away from the surface. With azimuths of both, or a relative one, the
/// mirror direction is opposite in azimuth. Signed angles in the plane of incidence are as in SEMI
/// ME1392: the mirror direction is at +theta_i. `out_of_plane` turns the direction out of that
/// plane. Angles without a stated unit are degrees if one is above pi/2, else radians; f is in
/// 1/sr, or pi f where names or the lines before them state it. Throws InputError, with `where` and
/// the line, for other content and where the table does not tell: angles up to 0.5 without a unit,
/// a value named `reflectance`, and samples that are brighter on the side of the light.
Samples readCsv(std::string_view text, const std::string& where, const CsvOptions& options = {});

/// The row of the table of formats.
const Format& csvFormat();

}  // namespace hshfit::brdfs
