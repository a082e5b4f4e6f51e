#pragma once

#include <brdfs/measured/scattered/table_columns.h>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// One row of a table of samples, angles as in the file.
struct TableRow {
    std::size_t line = 0;
    std::array<double, TableColumns::angleCount> angles{};
    std::array<double, TableColumns::vectorCount> vectors{};
    std::vector<double> values;  ///< by channel; NaN: not measured
    std::vector<double> sigmas;
    double wavelength = 0, scan = 0;
};

/// The rows of a table with named columns.
struct SampleTable {
    TableColumns columns;
    std::vector<TableRow> rows;
    std::size_t nameLine = 0;
    StatedQuantity before = StatedQuantity::none;  ///< by the lines before the names
    char separator = ',';
    std::size_t incomplete = 0;  ///< pairs that were left out for lack of a wavelength
};

/// The names of the angles, for messages.
inline constexpr std::array<std::string_view, TableColumns::angleCount> tableAngleNames = {
    "theta_i", "phi_i", "theta_o", "phi_o", "the relative azimuth", "the angle out of plane"};

/// Whether one of the first 200 lines names directions.
bool hasNamedColumns(std::string_view text);

/// Reads the table; with a column of wavelengths the rows of one pair of directions become one,
/// with a value for each of them. Throws InputError, with `where` and the line.
SampleTable readSampleTable(std::string_view text, const std::string& where);

/// Turns the rows of single wavelengths into one for each pair of directions, with a value for each
/// wavelength, ascending, and counts the pairs that lack some of them. A repeated measurement
/// begins a row of its own. `at` is the place of row 0, for messages.
void gatherWavelengths(SampleTable& table, const Row& at);

}  // namespace hshfit::brdfs
