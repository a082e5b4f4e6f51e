#pragma once

#include <hshfit/files/mapped_file.h>
#include <hshfit/gpu/texels.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline material_maps {

/// A written LevelFile, of which single texels are read.
class LevelTexture {
public:
    /// Throws InputError for sizes, which `sidecar` states, that are not halves of each other, and
    /// for a file whose head says something else.
    LevelTexture(const std::string& path, std::vector<LevelSize> levels, std::size_t layers,
                 gpu::Number number, const std::string& sidecar);

    /// The numbers of a texel as a GPU reads them: [layer * 4 + lane]. Throws UsageError for a
    /// texel or a level that there is not.
    std::vector<double> numbers(std::size_t level, std::size_t column, std::size_t row) const;
    /// A level as the file has it: [layer][row][column] of texels of four numbers.
    std::span<const std::byte> level(std::size_t level) const;
    /// All bytes of the file.
    std::span<const std::byte> file() const;
    const std::string& path() const { return texture_.path(); }
    /// Throws InputError if the file was changed since it was opened.
    void checkIntact() const { texture_.checkIntact(); }

private:
    std::string sidecar_;
    MappedFile texture_;
    std::vector<LevelSize> levels_;
    std::size_t layers_;
    gpu::Number number_;
    std::vector<std::size_t> offsets_, lengths_;  ///< of levels, in bytes
};

}  // namespace hshfit::inline material_maps
