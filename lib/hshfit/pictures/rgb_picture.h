#pragma once

#include <hshfit/files/atomic_file.h>

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline pictures {

/// The share of white that exposures aim at.
inline constexpr double shownAsWhite = 0.8;

/// Radiance, linear Rec. 709, row 0 at the top.
struct RgbPicture {
    int width = 0, height = 0;
    std::vector<float> values = {};  ///< [row][column][R, G, B]
};

/// The exposure, in stops, at which 95 % of the pixels have their largest channel at or below
/// `shownAsWhite`. Where 95 % have less than a 3,295th of the brightest pixel, the first step of
/// eight bits of sRGB above black, the exposure that shows this share of it as `shownAsWhite`: a
/// narrow highlight on black would show rounding errors otherwise. Rounded to a tenth; 0 for black.
double automaticExposure(const RgbPicture& picture);
/// The same exposure from the largest channel of each pixel.
double automaticExposure(std::vector<float> largest);

/// Throws NumericError, which names the picture and the pixel, for a value that is not finite.
void requireFinite(const std::string& name, std::size_t width, std::span<const float> rgb);

/// A PNG file, sRGB, 8 bits. `stops` doubles the radiance that often; values outside of [0, 1] are
/// then clamped. Throws NumericError for a value that is not finite.
std::string rgbPng(const RgbPicture& picture, double stops);

/// An OpenEXR file of 32-bit floats, R, G, B; pictures beside the first have channels with their
/// name and a dot before the colour. All of the same size. Throws NumericError for a value that is
/// not finite.
struct NamedPicture {
    std::string name;
    const RgbPicture* picture;
};
void writeRgbExr(const RgbPicture& picture, std::span<const NamedPicture> more, AtomicFile& file,
                 const std::map<std::string, std::string>& attributes = {});
/// Reads R, G, B of such a file, or of any flat OpenEXR picture. Throws InputError that starts with
/// `path`.
RgbPicture readRgbExr(const std::string& path);

/// Eight-bit pixels with alpha as PNG. Throws OutputError where that fails.
std::string pngOf(std::span<const unsigned char> rgba, std::size_t width, std::size_t height);
/// IEC 61966-2-1, to 8 bits; values outside of [0, 1] are clamped.
unsigned char encoded(double linear);

}  // namespace hshfit::inline pictures
