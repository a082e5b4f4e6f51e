#pragma once

#include <hshfit/material_maps/level_file.h>
#include <hshfit/material_maps/processes.h>
#include <hshfit/material_maps/texel_encoder.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace hshfit::inline material_maps {

/// The errors of the texels of a level, relative to the norm of each.
struct LevelErrors {
    double mean = 0, maximum = 0;
    std::size_t column = 0, row = 0;  ///< of the maximum
    double largest = 0;               ///< magnitude among the stored numbers
};

struct MapWritten {
    std::vector<LevelErrors> levels = {};
    /// Errors of the texels of one level, the largest with at most `pictureSide` texels a side: the
    /// largest of those that it stands for.
    LevelSize picture = {};
    std::vector<float> pictureErrors = {};
};

/// The size of the picture of errors, and a function that is told of progress.
struct MapWriterOptions {
    std::size_t pictureSide = 512;  ///< of the longer side, at most, pixels
    std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Bands of a map of these levels: rows that end up in whole rows of as many levels as can be, at
/// most 7. A band has at most 64 rows, `memory` permitting: enough for writes of a megabyte. More
/// memory would only take the system time to provide.
struct BandPlan {
    std::size_t rows = 1;    ///< of a band, but the last
    std::size_t count = 1;   ///< bands
    std::size_t levels = 1;  ///< that a band completes
};
BandPlan planBands(const std::vector<LevelSize>& sizes, std::size_t bytesOfTexel,
                   std::size_t memory);

/// Writes every level of a map, a band of rows in memory at a time. A texel of a level is the mean
/// of four (two, where a side is 1) of the level before it: of reflectance, which is linear in what
/// is averaged. The same bytes for any number of threads, bands and processes.
///
/// The first process returns the errors; the others return nothing. Throws NumericError for
/// numbers beyond the format, InputError and OutputError.
MapWritten writeMap(TexelSource& source, TexelEncoder& encoder, LevelFile& file,
                    const BandPlan& plan, Processes& processes,
                    const MapWriterOptions& options = {});

}  // namespace hshfit::inline material_maps
