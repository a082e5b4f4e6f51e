#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hshfit::brdfs {

// The tables of Dupuy & Jakob 2018, "An Adaptive Parameterization for Efficient Material
// Acquisition and Rendering", ACM TOG 37(6). Points (u, v) of the unit square are bilinear between
// vertices; u runs along columns (elevation), v along rows (azimuth).

/// A cell of a grid of vertices over the unit square, and the position within it.
struct GridPosition {
    std::size_t column, row;
    double a, b;  ///< from the cell's lower corner, 0 to 1, along u and v

    GridPosition(double u, double v, std::size_t columns, std::size_t rows) {
        const double x = std::clamp(u, 0.0, 1.0) * static_cast<double>(columns - 1);
        const double y = std::clamp(v, 0.0, 1.0) * static_cast<double>(rows - 1);
        column = std::min<std::size_t>(static_cast<unsigned>(x), columns - 2);
        row = std::min<std::size_t>(static_cast<unsigned>(y), rows - 2);
        a = x - static_cast<double>(column);
        b = y - static_cast<double>(row);
    }
};

/// A plain table over the square.
struct Plane {
    std::size_t rows = 0, columns = 0;
    std::vector<float> values;  ///< row by row

    double at(double u, double v) const {
        const GridPosition p(u, v, columns, rows);
        const float* corner = values.data() + p.row * columns + p.column;
        const double lower = corner[0] + p.a * (double{corner[1]} - corner[0]);
        const double upper =
            corner[columns] + p.a * (double{corner[columns + 1]} - corner[columns]);
        return lower + p.b * (upper - lower);
    }
};

/// Up to four slices of a table that depends on wi, with the weights of a bilinear interpolation
/// between the measured (phi_i, theta_i).
struct Slices {
    int count = 0;
    std::array<std::uint32_t, 4> index{};
    std::array<double, 4> weight{};
};

/// The measured incident directions, and positions between them.
struct IncidentGrid {
    std::vector<double> phi, theta;  ///< ascending, radians

    /// Angles outside of the grid take its nearest edge. Slice of (phi p, theta t): p |theta| + t.
    Slices slices(double phiIncident, double thetaIncident) const;
};

/// The distributions of visible normals, one per incident direction, and their cumulative
/// distributions, which map a half vector to the point of the unit square at which its colour is
/// stored. Between incident directions the normalised densities are interpolated.
class VisibleNormals {
public:
    /// densities[slice][row][column], not negative, every slice with a positive sum.
    VisibleNormals(const std::vector<float>& densities, std::size_t rows, std::size_t columns);

    struct Point {
        double x, y;
    };
    /// The inverse of sampling: y = P(row < v), x = P(column < u | v). Rows without any density
    /// keep x = u.
    Point invert(double u, double v, const Slices& slices) const;
    /// Sampling: the (u, v) that `invert` takes to (x, y) for one slice.
    Point sample(double x, double y, std::size_t slice) const;

    /// Per du dv, with the integral 1 over the square.
    double density(double u, double v, std::size_t slice) const;

    /// The densities as passed to the constructor.
    std::vector<float> densities() const;
    std::size_t rows() const { return rows_; }
    std::size_t columns() const { return columns_; }

    /// The tables behind `invert`, for evaluation in batches.
    struct View {
        const float* vertices;  ///< [slice][row][column]{density, before}
        const float* rowSums;   ///< [slice][row]{whole, below}
        const double* scale;    ///< [slice]
        std::size_t rows, columns;
    };
    View view() const;

private:
    struct Vertex {
        float density;
        float before;  ///< integral over the row up to here, in units of columns
    };
    struct RowSum {
        float whole;  ///< integral over the row, in units of columns
        float below;  ///< integral over the rows up to here
    };
    std::size_t rows_, columns_;
    std::vector<Vertex> vertices_;  ///< [slice][row][column]
    std::vector<RowSum> rowSums_;   ///< [slice][row]
    std::vector<double> scale_;     ///< [slice]: 1 / integral over the square
};

/// Colours over the square per incident direction.
struct Spectra {
    std::size_t channels = 0, rows = 0, columns = 0;
    std::vector<float> values;  ///< [slice][row][column][channel]

    /// out[c * stride] for every channel.
    void at(VisibleNormals::Point point, const Slices& slices, double factor, double* out,
            std::size_t stride) const;
};

}  // namespace hshfit::brdfs
