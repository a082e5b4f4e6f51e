#include <hshfit/material_maps/map_writer.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/material_maps/internal/level_texels.h>
#include <hshfit/material_maps/internal/tile_work.h>

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <future>
#include <map>
#include <optional>

namespace hshfit::inline material_maps {
namespace {

/// The numbers of a band, as floats: they travel between processes.
struct BandResult {
    std::vector<LevelErrors> errors = {};  ///< of the levels that the band completes
    std::vector<float> top = {};           ///< the last of them, in the numbers that are averaged
    LevelTexels picture = {};              ///< errors, one float a texel

    std::vector<float> floats() const {
        std::vector<float> out;
        for (const LevelErrors& e : errors) {
            for (const double value : {e.mean, e.maximum, static_cast<double>(e.column),
                                       static_cast<double>(e.row), e.largest})
                out.push_back(static_cast<float>(value));
        }
        out.insert(out.end(), top.begin(), top.end());
        out.insert(out.end(), picture.values.begin(), picture.values.end());
        return out;
    }
};
constexpr std::size_t floatsOfErrors = 5;

LevelErrors errorsFrom(const float* from) {
    return {.mean = static_cast<double>(from[0]),
            .maximum = static_cast<double>(from[1]),
            .column = static_cast<std::size_t>(from[2]),
            .row = static_cast<std::size_t>(from[3]),
            .largest = static_cast<double>(from[4])};
}

/// Adds the errors of further texels of a level.
void add(LevelErrors& sum, std::size_t& count, const LevelErrors& more, std::size_t texels) {
    sum.mean = (sum.mean * static_cast<double>(count) + more.mean * static_cast<double>(texels)) /
               static_cast<double>(count + texels);
    count += texels;
    sum.largest = std::max(sum.largest, more.largest);
    if (more.maximum > sum.maximum) {
        sum.maximum = more.maximum;
        sum.column = more.column;
        sum.row = more.row;
    }
}

/// Texels of a band on their way to the file, by level.
using BandLevels = std::vector<EncodedLevel>;

/// The work on a map that does not change from band to band.
class MapWork {
public:
    MapWork(TexelSource& source, TexelEncoder& encoder, LevelFile& file, const BandPlan& plan,
            const MapWriterOptions& options)
        : source_(source),
          encoder_(encoder),
          file_(file),
          plan_(plan),
          sizes_(levelSizes(source.width(), source.height())),
          writtenLevels_(std::min(plan.levels, file.sizes().size())),
          pictureLevel_(levelOfPicture(options.pictureSide)),
          tiles_([this] { return TileWork(encoder_, source_.layout().floats(), writtenLevels_); }) {
    }

    std::size_t topOf(std::size_t band) const { return band * plan_.rows; }
    std::size_t bottomOf(std::size_t band) const {
        return std::min(topOf(band) + plan_.rows, source_.height());
    }

    /// The levels of a band in bytes; its other results.
    BandResult levelsOf(std::size_t band, const TexelBand& texels, BandLevels& bytes) {
        BandResult result;
        const std::size_t width = source_.width(), rows = bottomOf(band) - topOf(band);
        reserve(rows, bytes);
        LevelTexels errors{.width = width, .height = rows, .step = 1};
        errors.values.resize(width * rows);
        if (hasTop()) {
            result.top.resize((width >> (writtenLevels_ - 1)) * (rows >> (writtenLevels_ - 1)) *
                              encoder_.linear());
        }
        result.errors = errorsOfTiles(rows, texels,
                                      {.top = topOf(band),
                                       .levels = bytes,
                                       .topLevel = hasTop() ? result.top.data() : nullptr,
                                       .errors = errors.values.data()});
        for (std::size_t level = 1; level <= std::min(pictureLevel_, plan_.levels - 1); ++level)
            errors = errors.largestOf(2, 2);
        result.picture = std::move(errors);
        return result;
    }

    void write(std::size_t band, const BandLevels& bytes) {
        for (std::size_t level = 0; level < writtenLevels_; ++level) {
            const EncodedLevel& from = bytes[level];
            file_.write(level, topOf(band) >> level, from.rows,
                        from.bytes.first(from.pitch() * encoder_.layers()));
        }
    }

    /// The levels that no band completes, and the errors of all.
    MapWritten finished(const std::map<std::size_t, BandBytes>& results) {
        MapWritten written{.levels = std::vector<LevelErrors>(writtenLevels_)};
        std::vector<std::size_t> counts(writtenLevels_, 0);
        LevelTexels top{.step = encoder_.linear()}, picture{.step = 1};
        for (const auto& [band, bytes] : results) {
            const std::vector<float> floats = bandValues<float>(bytes);
            const std::size_t rows = bottomOf(band) - topOf(band);
            for (std::size_t level = 0; level < writtenLevels_; ++level) {
                add(written.levels[level], counts[level],
                    errorsFrom(floats.data() + level * floatsOfErrors),
                    (rows >> level) * sizes_[level].width);
            }
            const float* from = floats.data() + writtenLevels_ * floatsOfErrors;
            if (hasTop()) {
                from = top.append(from, sizes_[writtenLevels_ - 1].width,
                                  rows >> (writtenLevels_ - 1));
            }
            const std::size_t pictured = std::min(pictureLevel_, plan_.levels - 1);
            picture.append(from, sizes_[pictured].width, rows >> pictured);
        }
        for (std::size_t level = writtenLevels_; level < file_.sizes().size(); ++level) {
            top = top.mean(sizes_[level - 1].width / sizes_[level].width,
                           sizes_[level - 1].height / sizes_[level].height);
            encoder_.learn(level, top.values);
            written.levels.push_back(writeWhole(level, top));
        }
        for (std::size_t level = plan_.levels; level <= pictureLevel_; ++level)
            picture = picture.largestOf(sizes_[level - 1].width / sizes_[level].width,
                                        sizes_[level - 1].height / sizes_[level].height);
        written.picture = {picture.width, picture.height};
        written.pictureErrors = std::move(picture.values);
        return written;
    }

private:
    std::size_t levelOfPicture(std::size_t side) const {
        std::size_t level = 0;
        while (level + 1 < sizes_.size() &&
               (sizes_[level].width > side || sizes_[level].height > side))
            ++level;
        return level;
    }

    /// Whether the end of the map continues from the last level of the bands.
    bool hasTop() const { return file_.sizes().size() > 1; }

    std::size_t bytesInLayer() const { return file_.bytesOfTexel() / encoder_.layers(); }

    void reserve(std::size_t rows, BandLevels& bytes) const {
        bytes.resize(writtenLevels_);
        for (std::size_t level = 0; level < writtenLevels_; ++level) {
            bytes[level].width = sizes_[level].width;
            bytes[level].rows = rows >> level;
            bytes[level].texelBytes = bytesInLayer();
            bytes[level].reserve(encoder_.layers());
        }
    }

    /// Makes the tiles of a band; the errors of its levels.
    std::vector<LevelErrors> errorsOfTiles(std::size_t rows, const TexelBand& texels,
                                           const BandTarget& target) {
        const std::size_t side = std::size_t{1} << (writtenLevels_ - 1);
        const std::size_t width = source_.width();
        const std::size_t height = TileWork::side / side * side;
        const std::size_t across = (width + TileWork::side - 1) / TileWork::side;
        const std::size_t down = (rows + height - 1) / height;
        std::vector<std::vector<ErrorSum>> sums(across * down);
        eachInParallel(across * down, [&](std::size_t k) {
            Tile tile{.row = k / across * height, .column = k % across * TileWork::side};
            tile.rows = std::min(height, rows - tile.row);
            tile.columns = std::min(TileWork::side, width - tile.column);
            sums[k] = tiles_.local().make(texels, tile, target);
        });
        std::vector<LevelErrors> errors;
        for (std::size_t level = 0; level < writtenLevels_; ++level) {
            ErrorSum sum;
            for (const auto& tile : sums) sum.add(tile[level]);
            errors.push_back(sum.result(target.top >> level));
        }
        return errors;
    }

    /// Encodes and writes a level.
    LevelErrors writeWhole(std::size_t level, const LevelTexels& texels) {
        EncodedLevel bytes{texels.width, texels.height, bytesInLayer()};
        bytes.reserve(encoder_.layers());
        std::vector<ErrorSum> rows(texels.height);
        eachInParallel(texels.height, [&](std::size_t row) {
            std::vector<float> errors(texels.width);
            const EncodedRange range =
                encoder_.encode(level, {texels.row(row), texels.width * texels.step},
                                {bytes.at(row, 0), bytes.pitch(), errors.data()});
            rows[row].add(range, errors, texels.width, row, 0);
        });
        ErrorSum sum;
        for (const ErrorSum& row : rows) sum.add(row);
        file_.write(level, 0, texels.height, bytes.bytes.first(bytes.pitch() * encoder_.layers()));
        return sum.result(0);
    }

    TexelSource& source_;
    TexelEncoder& encoder_;
    LevelFile& file_;
    const BandPlan& plan_;
    std::vector<LevelSize> sizes_;  ///< as if there were all levels
    std::size_t writtenLevels_;     ///< by bands
    std::size_t pictureLevel_;
    tbb::enumerable_thread_specific<TileWork> tiles_;
};

}  // namespace

BandPlan planBands(const std::vector<LevelSize>& sizes, std::size_t bytesOfTexel,
                   std::size_t memory) {
    const auto [width, height] = sizes.front();
    const std::size_t fit = std::max<std::size_t>(memory / (width * bytesOfTexel), 1);
    const std::size_t wanted = std::min({fit, TileWork::side, height});
    BandPlan plan;
    // Each level of a band halves both sides.
    while (plan.levels < sizes.size() && plan.rows * 2 <= std::max<std::size_t>(wanted, 2) &&
           sizes[plan.levels - 1].width % 2 == 0 && sizes[plan.levels - 1].height % 2 == 0) {
        plan.rows *= 2;
        ++plan.levels;
    }
    plan.rows *= std::max<std::size_t>(wanted / plan.rows, 1);
    plan.count = (height + plan.rows - 1) / plan.rows;
    return plan;
}

MapWritten writeMap(TexelSource& source, TexelEncoder& encoder, LevelFile& file,
                    const BandPlan& plan, Processes& processes, const MapWriterOptions& options) {
    MapWork work(source, encoder, file, plan, options);
    if (processes.isFirst()) file.begin();
    const auto dealer = processes.deal(plan.count);
    std::map<std::size_t, BandBytes> results;
    std::size_t done = 0;
    // One band is read and one is written while one is computed.
    const auto reading = [&](std::optional<std::size_t> band) {
        if (!band) return std::future<std::unique_ptr<TexelBand>>();
        return std::async(std::launch::async,
                          [&, b = *band] { return source.band(work.topOf(b), work.bottomOf(b)); });
    };
    std::optional<std::size_t> band = dealer->next();
    auto read = reading(band);
    BandLevels buffers[2];      // one is filled while the other is written
    std::future<void> writing;  // ends before the buffers do, also after an exception
    while (band) {
        const std::unique_ptr<TexelBand> texels = read.get();
        const std::size_t current = *band;
        band = dealer->next();
        read = reading(band);
        BandLevels& bytes = buffers[done % 2];
        results[current] = bandBytes(work.levelsOf(current, *texels, bytes).floats());
        if (writing.valid()) writing.get();
        writing = std::async(std::launch::async, [&, current] { work.write(current, bytes); });
        ++done;
        if (options.progress) options.progress(done, plan.count);
    }
    if (writing.valid()) writing.get();
    dealer->collect(results);
    return processes.isFirst() ? work.finished(results) : MapWritten{};
}

}  // namespace hshfit::inline material_maps
