#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/library_maps/library_sidecar.h>
#include <hshfit/material_maps/level_texture.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::inline library_maps {

/// A written map of coefficients in a library, of which single texels are read.
class LibraryMap {
public:
    /// `sidecar` is the path of the JSON file. Throws InputError for one that is invalid, for a
    /// texture whose head says something else, and for a library with another basis.
    explicit LibraryMap(const std::string& sidecar)
        : LibraryMap(readLibrarySidecar(sidecar), sidecar) {}
    /// The same for a sidecar that is not a file yet; `file` names it.
    LibraryMap(LibrarySidecar sidecar, std::string file);

    const LibrarySidecar& sidecar() const { return sidecar_; }
    const material_library::Basis& basis() const { return basis_; }
    const LevelTexture& texture() const { return texture_; }
    /// The numbers of a texel, as LibraryLayout has them. Throws UsageError for a texel or a level
    /// that the map does not have.
    std::vector<double> numbers(std::size_t level, std::size_t column, std::size_t row) const {
        return texture_.numbers(level, column, row);
    }
    std::unique_ptr<Brdf> texel(std::size_t level, std::size_t column, std::size_t row) const;
    /// Throws InputError if the texture file was changed since it was opened.
    void checkIntact() const { texture_.checkIntact(); }

private:
    std::string file_;
    LibrarySidecar sidecar_;
    material_library::Basis basis_;
    LevelTexture texture_;
};

/// The BRDF of such numbers.
std::unique_ptr<Brdf> brdfOf(const material_library::Basis& basis, const LibraryLayout& layout,
                             const std::vector<double>& numbers, const std::string& name);

}  // namespace hshfit::inline library_maps
