#pragma once

#include <hshfit/light/light_samples.h>

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline rendering {

/// Values that change smoothly with a surface's normal, at the vertices of a grid of normals, and
/// cubic interpolation in between. Six faces of a cube, in angles of equal steps, carry the grid;
/// vertices are kept about the normals that occur. Values belong to the axes of a face, which turn
/// smoothly over it: frameAt on four faces, and on the faces of +z and -z frameAt with +x in the
/// place of +z.
class NormalTable {
public:
    /// `perEdge` cells along an edge of the cube.
    NormalTable(std::span<const Direction> normals, int perEdge);

    std::size_t vertices() const { return frames_.size(); }
    /// The normal nearest the middle of each cell that has any.
    std::span<const std::size_t> middles() const { return middles_; }

    /// Writes the `count` values at the vertices, on all threads.
    using At = std::function<void(const Frame& frame, double* values)>;
    void fill(std::size_t count, const At& at);

    /// The cell of a normal, an index of `middles`.
    std::size_t cellOf(const Direction& normal) const;
    /// The cells beside it, across edges and corners, that have normals.
    std::vector<std::size_t> cellsAround(const Direction& normal) const;
    /// Interpolates the values at a normal. Returns the azimuth of frameAt(normal).tangent in the
    /// axes that the values are of.
    double interpolate(const Direction& normal, std::span<double> values) const;

private:
    /// The place of a normal in the grid of its face: a cell's lower corner and the rest.
    struct Place {
        std::size_t face, column, row;
        double x, y;
    };
    Place placeOf(const Direction& normal) const;
    Direction normalAt(std::size_t face, double column, double row) const;
    std::size_t vertexIndex(std::size_t face, std::size_t column, std::size_t row) const;
    std::size_t cellIndex(const Place& place) const;

    std::size_t perEdge_, count_ = 0;
    std::vector<Frame> frames_;            ///< of the vertices
    std::vector<std::size_t> vertexOf_;    ///< [face][row][column] of a grid with a rim
    std::vector<std::size_t> cellNumber_;  ///< [face][row][column]
    std::vector<std::size_t> middles_;
    std::vector<double> values_;  ///< [vertex][value]
};

}  // namespace hshfit::inline rendering
