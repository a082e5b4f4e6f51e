#pragma once

#include <hshfit/material_maps/processes.h>
#include <hshfit/material_maps/texel_layout.h>

#include <cstddef>
#include <memory>

namespace hshfit::inline material_maps {

/// Some rows of a map, read and ready.
class TexelBand {
public:
    virtual ~TexelBand() = default;
    /// out[texel][layout.floats()] of neighbours in one row. From several threads at once.
    virtual void texels(std::size_t row, std::size_t column, std::size_t count,
                        float* out) const = 0;
};

/// Texels of a map at its full size, row 0 at the top.
class TexelSource {
public:
    virtual ~TexelSource() = default;
    virtual std::size_t width() const = 0;
    virtual std::size_t height() const = 0;
    virtual const TexelLayout& layout() const = 0;
    /// Rows [top, bottom). Throws InputError. By one thread at a time; best with rising rows.
    virtual std::unique_ptr<TexelBand> band(std::size_t top, std::size_t bottom) = 0;
};

/// Sizes of the levels of a map: halves as long as both sides are even or 1.
struct LevelSize {
    std::size_t width = 1, height = 1;
    bool operator==(const LevelSize&) const = default;
};
std::vector<LevelSize> levelSizes(std::size_t width, std::size_t height, bool mips = true);

/// Texels on an even grid over a map, at most `most`: [texel][layout.floats()]. Shared out among
/// processes; each has all afterwards.
std::vector<float> sampleTexels(TexelSource& source, std::size_t most, Processes& processes);

}  // namespace hshfit::inline material_maps
