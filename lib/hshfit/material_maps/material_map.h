#pragma once

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/material_maps/level_texture.h>
#include <hshfit/material_maps/map_sidecar.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline material_maps {

/// A texel of layout.floats() as coefficients, with the head that the sidecar states.
Coefficients texelCoefficients(const MapSidecar& map, std::span<const float> texel);

/// A written map, of which single texels are read.
class MaterialMap {
public:
    /// A map whose sidecar is at hand, but for its name in messages.
    MaterialMap(MapSidecar sidecar, std::string file);
    /// `sidecar` is the path of the JSON file. Throws InputError for one that is invalid, and for a
    /// texture file whose head says something else.
    explicit MaterialMap(const std::string& sidecar);

    const MapSidecar& sidecar() const { return sidecar_; }
    /// The numbers of a texel as a GPU reads them: [layer * 4 + lane].
    std::vector<double> numbers(std::size_t level, std::size_t column, std::size_t row) const {
        return texture_.numbers(level, column, row);
    }
    /// The coefficients of a texel; for the form halfway, the coefficients of the centre that its
    /// `material` names. Throws UsageError for a texel or a level that the map does not have.
    Coefficients coefficients(std::size_t level, std::size_t column, std::size_t row) const;
    /// The index of the shared material of a texel, of the forms clusters and halfway. Throws
    /// InputError for one that there is not, and UsageError as `coefficients` does.
    std::size_t material(std::size_t level, std::size_t column, std::size_t row) const;
    /// LevelTexture::level.
    std::span<const std::byte> level(std::size_t level) const { return texture_.level(level); }
    /// LevelTexture::file.
    std::span<const std::byte> file() const { return texture_.file(); }
    /// Throws InputError if the texture file was changed since it was opened.
    void checkIntact() const { texture_.checkIntact(); }

private:
    std::string file_;
    MapSidecar sidecar_;
    LevelTexture texture_;
};

}  // namespace hshfit::inline material_maps
