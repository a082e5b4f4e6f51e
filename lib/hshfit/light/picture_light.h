#pragma once

#include <hshfit/light/lights.h>

#include <string>

namespace hshfit::inline light {

/// Reads an OpenEXR picture with channels R, G, B (or Y alone) and multiplies it by `scale`.
/// Throws InputError for anything else, a value below 0 or not finite, or one that is not twice as
/// wide as high.
PictureLight readPictureLight(const std::string& path, double scale);

/// Directions at (column, row) in pixels, fractions allowed, with the world's +z up.
Direction directionOf(const PictureLight& light, double column, double row);

/// Radiance seen in a direction: that of its pixel.
Rgb radianceOf(const PictureLight& light, const Direction& world);

/// A part of the picture as one sample: the mean direction weighted with the flux, and the integral
/// of radiance over it.
struct PictureSample {
    Direction direction;
    Rgb flux{};
};

/// The picture cut into quarters until each part is a pixel or holds at most the share `finest` of
/// the flux times its width in radians: bright and wide parts are cut, so that small lamps keep
/// their place and dark sky costs little. The fluxes sum to that of the picture.
std::vector<PictureSample> pictureSamples(const PictureLight& light, double finest);

}  // namespace hshfit::inline light
