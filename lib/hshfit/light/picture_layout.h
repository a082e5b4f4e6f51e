#pragma once

#include <hshfit/light/lights.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::inline light {

/// A layout and its name in specifications.
struct LayoutName {
    PictureLayout layout;
    std::string_view name, help;
};
std::span<const LayoutName> layoutNames();

/// Positions and directions of a picture's pixels, in the picture's own frame: +z up, forward +x.
/// A layout is a view from the inside, with forward in its middle and -y to the right, except the
/// mirror ball, a photograph that looks forward at a ball: its middle is -x, its rim +x.
/// latlong     azimuth = pi - 2 pi column / width, theta = pi row / height
/// angular     radius from the middle = angle from forward / pi (Debevec)
/// mirrorBall  radius = sine of half the angle from -x
/// cross       4 x 3 or 3 x 4 square faces; the back of 3 x 4 is turned by 180 degrees
/// faces       6 x 1 or 1 x 6 square faces, right, left, top, bottom, front, back, each turned as
///             in OpenGL's cube maps: +X, -X, +Y, -Y, +Z, -Z of a frame with Y up and Z forward
struct PictureGeometry {
    PictureLayout layout = PictureLayout::latlong;
    std::size_t width = 0, height = 0;

    /// At a position in pixels, fractions allowed; arbitrary outside of the used area.
    Direction direction(double column, double row) const;
    /// {column, row} of a direction, within [0, width) x [0, height).
    std::array<double, 2> position(const Direction& direction) const;
    /// Of a pixel; 0 outside of the used area. Exact for latlong, mirror balls inside the rim and
    /// cubes; from two Gauss nodes each way for angular maps.
    double solidAngle(std::size_t column, std::size_t row) const;
    /// Solid angle per pixel at a position in pixels; 0 outside of the used area.
    double density(double column, double row) const;
    /// The angle under which a pixel of average size is seen, radians.
    double pixelAngle() const;
    /// Width or height of one of the cube's faces in pixels; 0 for other layouts.
    std::size_t faceSize() const;
};

/// Whether a layout can have that size.
bool layoutFits(PictureLayout layout, std::size_t width, std::size_t height);
/// The only layout of a size, if there is one.
std::optional<PictureLayout> layoutOfSize(std::size_t width, std::size_t height);
/// The sizes of a layout in words, "twice as wide as high".
std::string_view layoutSizes(PictureLayout layout);
std::string_view layoutName(PictureLayout layout);

}  // namespace hshfit::inline light
