#pragma once

#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/material_maps/level_file.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace hshfit::inline filtered_maps {

/// The textures of a map of filtered lobes, written row by row in any order, by several processes
/// if need be.
class FilteredMapWriter {
public:
    /// The files stand: temporaries, say. `harmonics` is not used without harmonics.
    FilteredMapWriter(const FilteredSidecar& sidecar, const std::string& texture,
                      const std::string& harmonics);

    /// The heads and the lengths of the files, before anything else: by one process.
    void begin();
    /// A row of a level: layout.ellipseSize() numbers a texel for level 0, else layout.size().
    /// Throws NumericError for a number beyond the format, with its texel, and OutputError.
    void write(std::size_t level, std::size_t row, std::span<const double> texels);
    std::size_t bytes() const;

private:
    const FilteredSidecar& sidecar_;
    LevelFile texture_;
    std::unique_ptr<LevelFile> harmonics_;
};

}  // namespace hshfit::inline filtered_maps
