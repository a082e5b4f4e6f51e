#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/light/lights.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::inline light {

/// The sun of a picture and the rest, whose sum is the picture.
struct SunSplit {
    DiscLight sun;                  ///< in the world, with the picture's placement
    Rgb irradiance{};               ///< of a surface across the sun's light
    std::vector<FilledPixel> rest;  ///< the sun's pixels by row and column, filled; scaled
    double peak = 0;                ///< luminance of the sun's brightest pixel, scaled
    double surroundings = 0;        ///< the median about it
};

/// Finds the sun as follows. Luminance is by Rec. 709, and P is its largest value.
/// 1. Pixels of at least P / 10 form connected parts; the sun is in the one with the largest flux.
/// 2. B is the median, weighted with solid angle, from R to 2 R off the part's brightest pixel,
///    with R = 5 degrees or 3 pixels of average size, if that is more. There is no sun below
///    100 B.
/// 3. The sun's pixels are connected to the brightest pixel across edges and are brighter than the
///    geometric mean of its luminance and B (a thousandth of its luminance where B is 0). Their
///    neighbours are the sun's too. A part that goes beyond R is a lamp or a window and no sun.
/// The sun's pixels are filled as faulty pixels are, by Laplace's equation from the pixels around,
/// but never above the picture. The differences, constant within each pixel, have a flux F_c by
/// channel and a direction by the sum of all of them. The disc has this direction, the same mean
/// cosine about it, (1 + cos r) / 2, and F_c. So bands 0 are exact, bands 1 are exact for the sum
/// of the channels, and higher bands to second order in the angular size of the pixels.
///
/// Throws InputError that starts with the picture's name where it has no sun, or one of more than
/// 65536 pixels.
SunSplit splitSun(const PictureLight& picture);

/// Writes the rest as OpenEXR of single precision in the picture's own layout, without mirror,
/// tilt and turn; 12 bytes a pixel are held. `file` is not committed.
void writeRest(const PictureLight& picture, const SunSplit& split, AtomicFile& file);

/// "sun:elevation=…,azimuth=…,angle=…,irradiance=…", every number as exact as a double.
std::string sunSpecification(const SunSplit& split);

}  // namespace hshfit::inline light
