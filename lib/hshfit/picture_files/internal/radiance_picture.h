#pragma once

#include <hshfit/files/mapped_file.h>
#include <hshfit/picture_files/internal/image_module.h>

#include <memory>
#include <string>

namespace hshfit::inline picture_files {

/// A Radiance HDR picture of RGBE (Ward Larson & Shakespeare, "Rendering with Radiance", file
/// formats): flat, with the run lengths by component of today, or with the old ones, a pixel of
/// mantissas 1 that counts repetitions; in any of the eight orientations, given upright. A value is
/// mantissa 2^(exponent - 136). `file` has to outlive the picture. Null, with the reason in
/// `error`, for a head that is none and for scan lines that break off.
std::unique_ptr<ImageModulePicture> openRadiance(const MappedFile& file, std::string& error);

}  // namespace hshfit::inline picture_files
