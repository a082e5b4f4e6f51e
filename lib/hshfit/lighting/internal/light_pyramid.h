#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/light/light_nodes.h>
#include <hshfit/lighting/lobe_kernel.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace hshfit::lighting {

/// The face of a cube that a direction meets, and the place on it.
struct CubePoint {
    std::size_t face;
    double a, b;  ///< in [-1, 1]
};
CubePoint cubePoint(const Direction& d);

/// A kernel, and the chord beyond which it has little of its integral, so that cells may grow there
/// in size over distance: the square of that quotient by the square of the chord over the core, at
/// most 16 times.
struct PyramidKernel {
    std::vector<double> table;  ///< LobeKernel::Scaled::table
    double core = 2;

    explicit PyramidKernel(const LobeKernel::Scaled& kernel, double chord = 2)
        : table(kernel.table().begin(), kernel.table().end()), core(chord) {}
};

/// Light as a pyramid over the cells of a cube's faces. Far from an axis a kernel about it varies
/// slowly, so that a cell is one node at the middle of its flux if it is small beside its distance.
class LightPyramid {
public:
    /// Axes that are walked through the pyramid together, near each other to take the same cells.
    /// Each takes those that it would take alone.
    static constexpr std::size_t axesAtOnce = 16;
    using Axes = std::array<Direction, axesAtOnce>;
    using Sums = std::array<Rgb, axesAtOnce>;

    /// `width`: cells along a face in the finest level. Nodes that are many more than those cells
    /// are not kept: cells are an eighth of a kernel's width, so that what is lost is of the order
    /// of a hundredth of its curvature.
    LightPyramid(const LightNodes& nodes, std::size_t width);

    /// Adds the sum of flux times kernel(cosine) about each axis.
    void add(const Axes& axes, const PyramidKernel& kernel, Sums& sums) const;

    /// The size of a cell over its distance from the axis, at which it is one node.
    static constexpr double slender = 1.0 / 7;

    struct Cell {
        Direction sum{0, 0, 0};  ///< of |flux| times direction; after `centre` the direction
        Rgb flux{};
        bool any = false;

        void add(const Direction& d, const Rgb& f);
        void add(const Cell& other);
        void centre();
    };
    struct Level {
        std::size_t width = 0;
        std::vector<Cell> cells;  ///< [face][row][column]
    };
    std::vector<Level> levels;  ///< the finest first
    std::vector<Cell> nodes;    ///< by cells of the finest level; none: not kept
    /// The place in `nodes` of each of these cells' first, and the end.
    std::vector<std::size_t> first;

private:
    void keep(const LightNodes& all, const std::vector<std::size_t>& cellOf, std::size_t cells);
};

}  // namespace hshfit::lighting
