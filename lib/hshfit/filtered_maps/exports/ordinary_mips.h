#pragma once

#include <hshfit/files/file_set.h>
#include <hshfit/filtered_maps/filtered_map.h>

#include <array>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline filtered_maps::inline exports {

/// A filtered texel in the parameters of an engine's own GGX material, glTF 2.0 with
/// KHR_materials_anisotropy: the mean normal, and the widths alpha of an ellipse, the longer one
/// along `direction` in the plane of the surface. The square of each width is the lobe's squared
/// width plus twice the variance of the normals' slopes, as for Beckmann's alpha (Olano & Baker
/// 2010, "LEAN mapping").
struct OrdinaryTexel {
    Direction normal = {0, 0, 1};
    std::array<double, 2> direction = {1, 0};
    double longer = 0, shorter = 0;

    /// Perceptual: the root of the shorter width.
    double roughness() const;
    /// Strength of the anisotropy: longer = shorter + (1 - shorter) strength^2.
    double strength() const;
};
/// `numbers` are laid out as MipLayout says, with moments.
OrdinaryTexel ordinaryTexel(std::span<const double> numbers);

/// A written file, with the errors of its compression over all levels: for normals the angle in
/// radians, for roughness the difference, for anisotropy the larger of the strength's error and the
/// strength times the sine of the direction's error.
struct OrdinaryMips {
    std::string role, path;
    std::size_t bytes = 0;
    double largestError = 0, meanError = 0;
};

/// All levels of the map: NAME.normal.ktx2, BC5 with x and y; NAME.roughness.ktx2, BC7 with G the
/// roughness as of glTF's metallicRoughnessTexture, R and B 1; NAME.anisotropy.ktx2, BC7 as glTF's
/// anisotropyTexture, where a texel has any. Throws InputError and OutputError.
std::vector<OrdinaryMips> writeOrdinaryMips(const FilteredMap& map, const std::string& name,
                                            FileSet& files);

}  // namespace hshfit::inline filtered_maps::inline exports
