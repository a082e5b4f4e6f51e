#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/pictures/sphere.h>

#include <map>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline pictures {

/// The automatic exposure (rgb_picture.h) of the spheres' pixels: highlights may clip, surfaces do
/// not.
double automaticExposure(std::span<const SpherePicture> spheres);

/// approximation - reference, channel by channel. Of the same size.
SpherePicture sphereDifference(const SpherePicture& reference, const SpherePicture& approximation);

/// Mean over the pixels on the sphere and R, G, B of the radiance squared.
double meanSquare(const SpherePicture& sphere);

/// |radiance| times `factor`, for display.
SpherePicture amplified(const SpherePicture& difference, double factor);

/// The largest of 1, 2, 5, 10, … 1000 that keeps 98 % of the amplified difference, at this
/// exposure, within 0.8 of white; 1 where there is no difference.
double amplificationFor(const SpherePicture& difference, double stops);

/// A PNG file of the spheres side by side, sRGB, 8 bits, transparent around them. `stops` doubles
/// the radiance that often; values outside of [0, 1] are then clamped. All of the same size.
std::string spheresPng(std::span<const SpherePicture> spheres, double stops);

/// Writes the spheres side by side to `path`, a .png as spheresPng does or an .exr: channels
/// R, G, B (radiance times coverage, unexposed), A (coverage), and where pictures have errors
/// error.Y (relative), 32-bit float. Throws UsageError for
/// another extension, OutputError where it cannot be written.
void writeSpheres(std::span<const SpherePicture> spheres, double stops, const std::string& path,
                  const std::map<std::string, std::string>& attributes = {});
/// The same to an open file, by the extension of its path; not committed.
void writeSpheres(std::span<const SpherePicture> spheres, double stops, AtomicFile& file,
                  const std::map<std::string, std::string>& attributes = {});

/// Pictures in rows, from the top, each row from the left; all of the same size. The place of
/// missing pictures at the end of shorter rows is transparent.
using Sheet = std::vector<std::span<const SpherePicture>>;
std::string sheetPng(const Sheet& sheet, double stops);
/// The same as writeSpheres for more than one row.
void writeSheet(const Sheet& sheet, double stops, AtomicFile& file,
                const std::map<std::string, std::string>& attributes = {});

/// Checks the extension before any work. Throws the UsageError of writeSpheres.
void checkSpheresPath(const std::string& path);

}  // namespace hshfit::inline pictures
