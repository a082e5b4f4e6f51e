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
/// dome        the upper hemisphere in a disc: the zenith in the middle, radius = theta / (pi / 2),
///             forward at the lower edge, which is the view of somebody who leans back. Of pictures
///             4 x 1, the rows of latlong above the horizon (picture_reader.h)
/// equalArea   the octahedron in a square, all pixels of one solid angle (Clarberg 2008, as in
///             pbrt-v4): the zenith in the middle, the nadir at the corners. pbrt's x is our -x, as
///             its imgtool makes such a square of a latlong picture
struct PictureGeometry {
    PictureLayout layout = PictureLayout::latlong;
    std::size_t width = 0, height = 0;

    /// At a position in pixels, fractions allowed; arbitrary outside of the used area.
    Direction direction(double column, double row) const;
    /// {column, row} of a direction, within [0, width) x [0, height); arbitrary for directions that
    /// the picture does not cover.
    std::array<double, 2> position(const Direction& direction) const;
    /// Whether the picture has a pixel for a direction: all but domes have one for each.
    bool covers(const Direction& direction) const;
    /// The pixel across the edge to the right (1, 0), left, above (0, -1) or below, also over the
    /// edges of the picture and of the faces of a cube; none beside the used area of discs.
    std::optional<std::array<std::size_t, 2>> neighbour(std::size_t column, std::size_t row,
                                                        int right, int down) const;
    /// Solid angle of a pixel; 0 outside of the used area. Exact for latlong, mirror balls inside
    /// the rim, cubes and squares of equal area; from two Gauss nodes each way for angular maps and
    /// domes.
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
