#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::lighting {

/// The elevations of a table's rows: row k of n is at cos(theta_o) = 1 - (1 - leastCosine)
/// (k / (n - 1))^2, from the normal to 89.4 degrees, denser towards the normal where lobes are
/// mirrored and towards the horizon in angle alike.
struct ElevationRows {
    static constexpr double leastCosine = 0.01;
    std::size_t count = 32;  ///< at least 2

    double cosine(std::size_t row) const;
    /// A row and the share of the one after it; elevations below the last row are the last row's.
    struct Place {
        std::size_t row = 0;
        double share = 0;
    };
    Place place(double cosine) const;
};

/// Numbers by elevation as shaders read them: texels of four, interpolated linearly between rows.
struct ElevationTable {
    ElevationRows rows = {};
    std::size_t texels = 0;      ///< of a row
    std::vector<double> values;  ///< [row][texel][4]

    ElevationTable() = default;
    ElevationTable(ElevationRows rows, std::size_t texels);

    std::span<double> row(std::size_t k);
    std::span<const double> row(std::size_t k) const;
    /// The interpolated row at an elevation: 4 texels numbers to `out`.
    void at(double cosine, std::span<double> out) const;
};

}  // namespace hshfit::lighting
