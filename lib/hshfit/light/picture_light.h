#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/light/picture_layout.h>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline light {

/// A code of values and its name in specifications.
struct CurveName {
    TransferCurve curve;
    std::string_view name, help;
};
std::span<const CurveName> curveNames();

/// Facts that a file may not tell.
struct PictureOptions {
    std::optional<PictureLayout> layout = {};  ///< none: by the size
    std::optional<TransferCurve> curve = {};   ///< none: linear, for floating-point files only
};

/// Whether a text is the path of a file.
bool isPicturePath(std::string_view text);

/// Reads a picture and multiplies it by `scale`. Throws InputError, which names the file, for a
/// value below 0 or not finite, a size that does not fit the layout, or a file that cannot be read.
PictureLight readPictureLight(const std::string& path, double scale,
                              const PictureOptions& options = {});

/// The layout with the size of `rgb`, or with that of the rows of forEachRow.
PictureGeometry geometryOf(const PictureLight& light);
PictureGeometry fileGeometryOf(const PictureLight& light);

/// Calls `visit(row, rgb)` for each row from the top at the full resolution of the file, with
/// fileGeometryOf(light).width times R, G, B, scaled: from memory, or from the file again, a few
/// rows at a time, where `light.rgb` is a reduction of it. Throws InputError as reading does.
void forEachRow(const PictureLight& light,
                const std::function<void(std::size_t row, std::span<const float> rgb)>& visit);

/// Directions in the world at (column, row) in pixels of `rgb`, fractions allowed.
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
