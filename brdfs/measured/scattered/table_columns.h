#pragma once

#include <brdfs/measured/scattered/samples.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The quantity of a value: f in 1/sr, or pi f, 1 for an ideal Lambert surface. `unclear`: a name
/// that stands for either.
enum class StatedQuantity { none, brdf, radianceFactor, unclear };

enum class AngleUnit { unstated, degrees, radians };

/// The columns of a table of samples by their names, in any case, with units in brackets or as the
/// last word, and with '_', '-', '.' or blanks between words:
///     directions  theta_i, phi_i, theta_o, phi_o and their usual other names (incident_angle, aoi,
///                 sza, src_z; view_angle, vza, theta_r, measure_angle; …), a relative azimuth
///                 (phi, raa), out_of_plane; or wi_x … wo_z
///     values      brdf, brf, reflectance_factor, …; R, G, B; wavelengths (550nm, 0.55um, 550);
///                 or one of the former with a column `wavelength`, a row for each
///     errors      sigma, uncertainty, std, or one with the name of each value (sigma_550nm), in
///                 the unit of the values or in percent of them
///     scan        scan, run
/// Other columns are not read.
struct TableColumns {
    enum Angle { thetaI, phiI, thetaO, phiO, relative, outOfPlane, angleCount };
    static constexpr std::size_t vectorCount = 6;

    std::array<std::optional<std::size_t>, angleCount> angles;
    std::array<AngleUnit, angleCount> units{};
    std::array<std::optional<std::size_t>, vectorCount> vectors;  ///< wi_x, wi_y, … wo_z
    std::vector<std::size_t> values;
    Channels channels;
    StatedQuantity quantity = StatedQuantity::none;
    std::optional<std::size_t> wavelength;
    double nanometres = 0;            ///< one unit of `wavelength`; 0: by its size
    std::vector<std::size_t> sigmas;  ///< of each value, or one for all; or none
    bool percent = false;             ///< the unit of `sigmas`
    std::optional<std::size_t> scan;
    std::vector<std::string> unread;
    std::size_t count = 0;

    bool hasVectors() const { return vectors[0].has_value(); }
};

/// The cells of a line between `separator` (' ': any blanks), without blanks and quotation marks
/// around them. A separator within quotation marks separates nothing.
void splitCells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// Whether the line names both directions and a value: the one with the names of the columns.
bool namesDirections(std::string_view line);

/// The separator of a line of names: the first of tab, ';' and ',' that it has, or ' '.
char separatorOf(std::string_view line);

/// Reads the line with the names. `row` is its place, for messages. Throws InputError for names
/// that come twice, or that leave a direction or the values open.
TableColumns tableColumns(std::string_view line, const Row& row);

/// The quantity that a text of words names: "BRF Values"; unclear if it names both.
StatedQuantity quantityIn(std::string_view text);

}  // namespace hshfit::brdfs
