#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/light/picture_reader.h>

#include <span>
#include <string>
#include <vector>

namespace hshfit::inline light {

/// Pictures of more pixels are held as a reduction, a box filter that keeps the flux, whose sides
/// are whole fractions of the file's, or next to them.
inline constexpr std::size_t mostHeldPixels = std::size_t{1} << 23;

/// The treatment of pixels below 0, infinite or not a number. zero: as 0 in all channels, for
/// reports; clamped: components below 0 or not a number as 0, infinite ones as 65504, the largest
/// half; inpainted: all channels from the pixels around (internal/picture_filling.h).
enum class InvalidPixels { refused, zero, clamped, inpainted };

/// Reads a picture (picture_reader.h) and multiplies it by `scale`. Pixels outside of the layout's
/// used area do not count. Throws InputError, which names the file, for invalid pixels, with their
/// number and the first place, unless they are to be replaced, and as PictureReader does.
PictureLight readPictureLight(const std::string& path, double scale,
                              const PictureOptions& options = {},
                              InvalidPixels invalid = InvalidPixels::refused);

/// The remarks of all pictures among the lights.
std::vector<std::string> remarksOf(std::span<const Light> lights);

/// The layout with the size of `rgb`, or with the size of the rows of forEachRow.
PictureGeometry geometryOf(const PictureLight& light);
PictureGeometry fileGeometryOf(const PictureLight& light);

/// The options with which PictureReader reads the file of a light again.
PictureOptions optionsOf(const PictureLight& light);

/// Calls `visit(row, rgb)` for each row from the top at the full resolution of the file, with
/// fileGeometryOf(light).width times R, G, B, scaled: from memory, or from the file again, a few
/// rows at a time, where `light.rgb` is a reduction of it. Throws InputError as reading does.
void forEachRow(const PictureLight& light, const RowVisitor& visit);

/// A vector in the picture's own frame in the world, and back.
Direction toWorld(const PictureLight& light, Direction inPicture);
Direction toPicture(const PictureLight& light, const Direction& world);

/// Directions in the world at (column, row) in pixels of `rgb`, fractions allowed.
Direction directionOf(const PictureLight& light, double column, double row);

/// Radiance seen in a direction: the value of its pixel; 0 below a dome.
Rgb radianceOf(const PictureLight& light, const Direction& world);

/// A part of the picture as one sample: the mean direction weighted with the flux, and the integral
/// of radiance over it.
struct PictureSample {
    Direction direction;
    Rgb flux{};
};

/// The picture cut into quarters until each part is a pixel or holds at most the share `finest` of
/// the flux times its width in radians: bright and wide parts are cut, so that small lamps keep
/// their place and dark sky costs little. The fluxes sum to the picture's flux.
std::vector<PictureSample> pictureSamples(const PictureLight& light, double finest);

}  // namespace hshfit::inline light
