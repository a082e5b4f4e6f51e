#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/lighting/lobe_kernel.h>

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::lighting {

/// A cube map with levels, each half as wide as the one before. Faces +x -x +y -y +z -z of the
/// world, oriented as OpenGL 4.6, section 8.13, states, so that a lookup by the world's direction
/// needs no change of axes.
struct EnvironmentCube {
    struct Level {
        std::size_t face = 0;    ///< texels along an edge
        std::vector<float> rgb;  ///< [face][row][column][3]
    };
    std::vector<Level> levels;

    std::size_t texels() const;
    /// Trilinear, with texels beyond an edge taken from the neighbouring face.
    Rgb at(const Direction& world, double level) const;
};

/// The direction, not normalised, through a point of a face; a, b in [-1, 1] to the right and down.
Direction cubeDirection(std::size_t face, double a, double b);

/// Convolution of light with a kernel of cos(angle) that integrates to 1:
///     P(d) = integral of L(w) K(d . w) d omega   at the centre of each texel.
/// Nodes of the lights resolve functions of `order` bands. Runs on all threads.
EnvironmentCube::Level convolve(std::span<const Light> lights, std::size_t face, int order,
                                const LobeKernel::Scaled& kernel);
/// The same for a level of another cube, each of whose texels is a node. A tenth of the kernel's
/// integral, at most, is beyond the chord `core`.
EnvironmentCube::Level convolve(const EnvironmentCube::Level& light, std::size_t face,
                                const LobeKernel::Scaled& kernel, double core);

/// The mean radiance over each texel, from four directions in it; of discs, panels and single
/// directions the flux that falls into it.
EnvironmentCube::Level rasterised(std::span<const Light> lights, std::size_t face);

}  // namespace hshfit::lighting
