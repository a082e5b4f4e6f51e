#pragma once

#include <hshfit/light/catalog.h>
#include <hshfit/light/picture_light.h>

#include <array>
#include <string>
#include <vector>

namespace hshfit::inline light {

/// A light as a whole. Radiance by pixel: of the first picture at its full resolution, with what
/// other lights add in the pixels' middles, or of a grid of 1024 x 512 where there is no picture.
/// Pixels on the edge of a disc or panel count in 8 x 8 parts, and the flux of both is exact. Discs
/// and panels narrower than 4 degrees, and directional lights, stand beside the grid, before the
/// radiance in their middle.
struct LightHealth {
    Rgb mean{};  ///< radiance over the sphere
    Rgb peak{};  ///< radiance with the largest sum of components; infinite for a direction
    Direction peakDirection{};
    /// The share of the flux, all channels, in the brightest 0.1 % of the sphere, within 1 %.
    double brightestShare = 0;
    /// Largest over smallest sum of components, of pixels above 0; 0 for darkness, and where
    /// radiance goes below 0: its least value above 0 then depends on the grid alone.
    double dynamicRange = 0;
    double blackShare = 0;  ///< of the sphere
    /// The share of the sphere with a component below 0, as sums of harmonics have it beside sharp
    /// lights, and the least component there. `mean` and `brightestShare` count it as it is.
    double negativeShare = 0, leastNegative = 0;
    double aboveHalf = 0;        ///< largest component over 65504, the largest of a 16-bit float
    bool clippedByHalf = false;  ///< a component is above that
    bool blackInHalf = false;    ///< all light is below 2^-25, which a 16-bit float holds as 0
    PictureCensus invalid = {};  ///< in the files of all pictures; these count as 0
};

/// The facts about the sum of lights.
LightHealth examine(const std::vector<Light>& lights);

/// "disc", "panel", "sky", "picture", "direction" or "coefficients".
std::string_view kindOf(const Light& light);

}  // namespace hshfit::inline light
