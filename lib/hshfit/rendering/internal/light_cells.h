#pragma once

#include <hshfit/light/picture_light.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline rendering {

/// A part of a picture or a sky, seen as one direction.
struct LightCell {
    Direction direction = {};  ///< in the world
    Rgb flux{};                ///< the integral of radiance over the cell
    double width = 0;          ///< angle, radians
    std::size_t light = 0;
    /// The place: column and row in a level of the picture's pyramid, or below a pixel (level -1)
    /// the corner and the size in pixels.
    int level = 0;
    double u = 0, v = 0, size = 1;
};

/// The sum of skies and uniform lights as a latitude-longitude picture. A pixel has the radiance in
/// its middle: with 1024 columns the mean over a pixel differs by less than 1e-4 in the gradient
/// about the sun of the CIE's clearest sky, exp(-3 chi).
Light skyPicture(std::span<const Light> lights);

/// All skies, and uniform lights beside a sky, as one picture; other lights as they are.
std::vector<Light> withOneSky(std::span<const Light> lights);

/// Pictures as trees of cells: each cell is cut into four, down to a 16th of a pixel's width,
/// within which radiance is constant. The flux of a picture's cells is the same at each level.
class LightCells {
public:
    /// Other lights than pictures are left out. `finest`: the share of a light's flux times width,
    /// in radians, that a coarse cell has at most.
    LightCells(std::vector<Light> lights, double finest);

    /// Cells of all lights, none wider than 0.35 or with more of the flux than that. Dark ones are
    /// left out.
    const std::vector<LightCell>& coarse() const { return coarse_; }

    /// Writes the parts of a cell, and returns their number: 0 for a cell that is not cut.
    std::size_t split(const LightCell& cell, std::array<LightCell, 4>& parts) const;

private:
    struct Sum {
        float flux[3], direction[3];  ///< of flux times direction; in trees, that direction
    };
    struct Level {
        std::size_t width = 0, height = 0;
        std::vector<Sum> sums;
    };
    struct Tree {
        PictureGeometry geometry;
        std::vector<double> widths;  ///< of cells by level, from single pixels on
        /// Single pixels, where they are not too many to keep; empty if they are.
        std::vector<Sum> pixels;
        std::vector<Level> levels;  ///< from 2 x 2 pixels on; the last has one cell
    };

    void addPyramid(const PictureLight& light, Tree& tree) const;
    Sum pixelSum(const PictureLight& light, const PictureGeometry& geometry, std::size_t column,
                 std::size_t row) const;
    static Sum towards(Sum sum);
    LightCell pictureCell(std::size_t light, int level, std::size_t column, std::size_t row) const;
    std::size_t splitPixel(const LightCell& cell, std::array<LightCell, 4>& parts) const;
    void addCoarse(const LightCell& cell, double total);

    double finest_;
    std::vector<Light> lights_;
    std::vector<Tree> trees_;  ///< by light; empty for other lights
    std::vector<LightCell> coarse_;
};

}  // namespace hshfit::inline rendering
