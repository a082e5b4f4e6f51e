#pragma once

#include <hshfit/material_maps/internal/level_rows.h>
#include <hshfit/material_maps/internal/page_buffer.h>
#include <hshfit/material_maps/map_writer.h>
#include <hshfit/material_maps/texel_encoder.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline material_maps {

/// Rows of one level that a band holds, encoded: [layer][row][column].
struct EncodedLevel {
    std::size_t width = 0, rows = 0, texelBytes = 0;
    PageBuffer bytes = {};

    void reserve(std::size_t layers) { bytes.reserve(layers * pitch()); }
    std::size_t pitch() const { return width * rows * texelBytes; }
    std::byte* at(std::size_t row, std::size_t column) {
        return bytes.data() + (row * width + column) * texelBytes;
    }
};

/// Sums of errors of texels, added up in any grouping that keeps the order.
struct ErrorSum {
    double sum = 0;
    std::size_t count = 0;
    LevelErrors errors = {};  ///< without the mean
    bool finite = true;

    void add(const EncodedRange& range, const std::vector<float>& of, std::size_t texels,
             std::size_t row, std::size_t column);
    void add(const ErrorSum& more);
    /// Throws NumericError if a number is not finite or beyond the format.
    LevelErrors result(std::size_t firstRow) const;
};

/// The part of a band that one thread makes: rows of `columns` neighbours, and the levels of their
/// means, without leaving the processor's cache.
struct Tile {
    std::size_t row = 0, rows = 0;  ///< of level 0, within the band
    std::size_t column = 0, columns = 0;
};

/// The memory that the tiles of a band fill.
struct BandTarget {
    std::size_t top = 0;                ///< the band's first row in the map
    std::vector<EncodedLevel>& levels;  ///< that the band completes
    float* topLevel = nullptr;          ///< the last of them in float32, if wanted
    float* errors = nullptr;            ///< [row][column] of level 0
};

/// Makes tiles, one after another; one for each thread.
class TileWork {
public:
    static constexpr std::size_t side = 64;  ///< of a tile, at most

    TileWork(const TexelEncoder& encoder, std::size_t floatsOfTexel, std::size_t levels);
    /// Sums of errors of each level.
    std::vector<ErrorSum> make(const TexelBand& texels, const Tile& tile, const BandTarget& band);

private:
    const TexelEncoder& encoder_;
    std::size_t floats_, levels_;
    LevelRows rows_;
    std::vector<float> texels_, errors_;
};

}  // namespace hshfit::inline material_maps
