#pragma once

#include <hshfit/material_maps/level_file.h>
#include <hshfit/material_maps/texel_encoder.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

namespace hshfit::inline material_maps {

/// Deals the bands of a map to the processes that share the work, and brings their results to the
/// first of them.
class BandDealer {
public:
    virtual ~BandDealer() = default;
    /// The next band that nobody has yet; none: all are taken.
    virtual std::optional<std::size_t> next() = 0;
    /// Afterwards the first process has the results of all, by band, and the others none.
    virtual void collect(std::map<std::size_t, std::vector<float>>& results) { (void)results; }
    virtual bool isFirst() const { return true; }
};

/// All bands, in order.
class OneProcess final : public BandDealer {
public:
    explicit OneProcess(std::size_t bands) : bands_(bands) {}
    std::optional<std::size_t> next() override {
        return next_ < bands_ ? std::optional(next_++) : std::nullopt;
    }

private:
    std::size_t bands_, next_ = 0;
};

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

struct MapWriterOptions {
    std::size_t memory = std::size_t{512} << 20;  ///< bytes that a band may take
    std::size_t pictureSide = 512;
    std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Bands of a map of these levels: rows that end up in whole rows of as many levels as can be.
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
MapWritten writeMap(TexelSource& source, const TexelEncoder& encoder, LevelFile& file,
                    const BandPlan& plan, BandDealer& dealer, const MapWriterOptions& options = {});

}  // namespace hshfit::inline material_maps
