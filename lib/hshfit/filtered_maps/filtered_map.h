#pragma once

#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/material_maps/level_texture.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::inline filtered_maps {

/// A written map of filtered lobes, of which single texels are read.
class FilteredMap {
public:
    /// `sidecar` is the path of the JSON file. Throws InputError for one that is invalid, and for
    /// texture files whose heads say something else.
    explicit FilteredMap(const std::string& sidecar)
        : FilteredMap(readFilteredSidecar(sidecar), sidecar) {}
    /// The same for a sidecar that is not a file yet; `file` names it.
    FilteredMap(FilteredSidecar sidecar, std::string file);

    const FilteredSidecar& sidecar() const { return sidecar_; }
    const std::string& file() const { return file_; }
    /// The numbers of MipLayout, moments and all: layout.size() of them where the map has
    /// harmonics and the level is not 0, else layout.ellipseSize(). Throws UsageError for a texel
    /// or a level that the map does not have.
    std::vector<double> numbers(std::size_t level, std::size_t column, std::size_t row) const;
    /// The textures as they are stored; of harmonics, whose first level is the map's level 1, none
    /// in other forms.
    const LevelTexture& texture() const { return texture_; }
    const LevelTexture* harmonics() const { return harmonics_.get(); }
    /// Throws InputError if a texture file was changed since it was opened.
    void checkIntact() const;

private:
    std::string file_;
    FilteredSidecar sidecar_;
    LevelTexture texture_;
    std::unique_ptr<LevelTexture> harmonics_;
};

}  // namespace hshfit::inline filtered_maps
