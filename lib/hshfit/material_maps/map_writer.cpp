#include <hshfit/material_maps/map_writer.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/material_maps/internal/level_texels.h>

#include <fmt/format.h>

#include <algorithm>
#include <future>

namespace hshfit::inline material_maps {
namespace {

constexpr std::size_t chunkTexels = 64;

/// Encodes rows of a level and writes them to the file.
class LevelWriter {
public:
    LevelWriter(const TexelEncoder& encoder, LevelFile& file) : encoder_(encoder), file_(file) {}

    /// Rows of a level from row `top` on, in the numbers that are averaged; returns them.
    LevelTexels written(LevelTexels texels, std::size_t level, std::size_t top,
                        std::vector<LevelErrors>& errors) const {
        std::vector<std::byte> bytes(texels.count() * file_.bytesOfTexel());
        const std::size_t rowBytes = texels.width * file_.bytesOfTexel() / encoder_.layers();
        std::vector<EncodedTexels> rows(texels.height);
        eachInParallel(texels.height, [&](std::size_t row) {
            rows[row] = encoder_.encode(texels.row(row), texels.width,
                                        bytes.data() + row * rowBytes, texels.height * rowBytes);
        });
        errors.push_back(errorsOfRows(rows, top));
        file_.write(level, top, texels.height, bytes);
        return texels;
    }

    static LevelErrors errorsOfRows(const std::vector<EncodedTexels>& rows, std::size_t top);

private:
    const TexelEncoder& encoder_;
    LevelFile& file_;
};

[[noreturn]] void refuse(std::size_t row, float largest) {
    throw NumericError(fmt::format(
        "from row {} on, a number of {:.3g} is not finite or beyond float16 (65504); store float32",
        row, largest));
}

LevelErrors LevelWriter::errorsOfRows(const std::vector<EncodedTexels>& rows, std::size_t top) {
    LevelErrors result;
    std::size_t count = 0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        if (!rows[row].finite) refuse(top + row, rows[row].largest);
        result.largest = std::max(result.largest, static_cast<double>(rows[row].largest));
        for (std::size_t column = 0; column < rows[row].errors.size(); ++column) {
            const auto error = static_cast<double>(rows[row].errors[column]);
            result.mean += error;
            ++count;
            if (error > result.maximum) {
                result.maximum = error;
                result.column = column;
                result.row = top + row;
            }
        }
    }
    result.mean /= static_cast<double>(std::max<std::size_t>(count, 1));
    return result;
}

/// The numbers of a band, as floats: they travel between processes.
struct BandResult {
    std::vector<LevelErrors> errors = {};  ///< of the levels that the band completes
    LevelTexels top = {};                  ///< the last of them
    LevelTexels picture = {};              ///< errors, one float a texel

    std::vector<float> floats() const {
        std::vector<float> out;
        for (const LevelErrors& e : errors) {
            for (const double value : {e.mean, e.maximum, static_cast<double>(e.column),
                                       static_cast<double>(e.row), e.largest})
                out.push_back(static_cast<float>(value));
        }
        out.insert(out.end(), top.values.begin(), top.values.end());
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

/// The work on a map that does not change from band to band.
class MapWork {
public:
    MapWork(TexelSource& source, const TexelEncoder& encoder, LevelFile& file, const BandPlan& plan,
            const MapWriterOptions& options)
        : source_(source),
          encoder_(encoder),
          file_(file),
          plan_(plan),
          sizes_(levelSizes(source.width(), source.height())),
          writtenLevels_(std::min(plan.levels, file.sizes().size())),
          pictureLevel_(levelOfPicture(options.pictureSide)) {}

    std::size_t topOf(std::size_t band) const { return band * plan_.rows; }
    std::size_t bottomOf(std::size_t band) const {
        return std::min(topOf(band) + plan_.rows, source_.height());
    }

    /// Level 0 of a band, in bytes, and the levels above it, written.
    BandResult levelsOf(std::size_t band, const TexelBand& texels, std::vector<std::byte>& bytes) {
        BandResult result;
        LevelTexels errors;
        LevelTexels next = firstLevel(band, texels, bytes, errors, result.errors);
        const LevelWriter writer(encoder_, file_);
        const std::size_t top = topOf(band);
        for (std::size_t level = 1; level < plan_.levels; ++level) {
            if (level <= pictureLevel_) errors = errors.largestOf(2, 2);
            if (level >= writtenLevels_) continue;
            if (level > 1) next = next.mean(2, 2);
            next = writer.written(std::move(next), level, top >> level, result.errors);
        }
        if (hasTop()) result.top = std::move(next);
        result.picture = std::move(errors);
        return result;
    }

    /// The levels that no band completes, and the errors of all.
    MapWritten finished(const std::map<std::size_t, std::vector<float>>& results) {
        MapWritten written{.levels = std::vector<LevelErrors>(writtenLevels_)};
        std::vector<std::size_t> counts(writtenLevels_, 0);
        LevelTexels top{.step = encoder_.linear()}, picture{.step = 1};
        for (const auto& [band, floats] : results) {
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
        finishLevels(std::move(top), written);
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

    void finishLevels(LevelTexels top, MapWritten& written) {
        const LevelWriter writer(encoder_, file_);
        for (std::size_t level = writtenLevels_; level < file_.sizes().size(); ++level) {
            top = top.mean(sizes_[level - 1].width / sizes_[level].width,
                           sizes_[level - 1].height / sizes_[level].height);
            top = writer.written(std::move(top), level, 0, written.levels);
        }
    }

    /// Encodes level 0 and returns the means of level 1, or level 0 where bands complete no more.
    LevelTexels firstLevel(std::size_t band, const TexelBand& texels, std::vector<std::byte>& bytes,
                           LevelTexels& errors, std::vector<LevelErrors>& summed) {
        const std::size_t width = source_.width(), rows = bottomOf(band) - topOf(band);
        const std::size_t together = plan_.levels > 1 ? 2 : 1, n = encoder_.linear();
        const std::size_t chunks = (width + chunkTexels - 1) / chunkTexels;
        const bool more = writtenLevels_ > 1;
        LevelTexels next{
            .width = more ? width / 2 : width, .height = more ? rows / 2 : rows, .step = n};
        if (hasTop()) next.values.resize(next.count() * n);
        errors = {.width = width, .height = rows, .step = 1};
        errors.values.resize(width * rows);
        bytes.resize(width * rows * file_.bytesOfTexel());
        const std::size_t texelBytes = file_.bytesOfTexel() / encoder_.layers();
        const std::size_t floats = source_.layout().floats();
        std::vector<EncodedTexels> encoded(rows / together * chunks * together);
        eachInParallel(rows / together * chunks, [&](std::size_t task) {
            const std::size_t column = task % chunks * chunkTexels, row = task / chunks * together;
            const std::size_t count = std::min(chunkTexels, width - column);
            std::vector<float> whole(count * floats);
            LevelTexels block{.width = count, .height = together, .step = n};
            block.values.resize(block.count() * n);
            for (std::size_t k = 0; k < together; ++k) {
                texels.texels(topOf(band) + row + k, column, count, whole.data());
                for (std::size_t t = 0; t < count; ++t)
                    encoder_.reduce(whole.data() + t * floats, block.row(k) + t * n);
                EncodedTexels& done = encoded[task * together + k];
                done = encoder_.encode(block.row(k), count,
                                       bytes.data() + ((row + k) * width + column) * texelBytes,
                                       rows * width * texelBytes);
                std::ranges::copy(done.errors, errors.row(row + k) + column);
            }
            if (more) block = block.mean(2, 2);
            if (!hasTop()) return;
            const std::size_t halving = more ? 2 : 1;
            for (std::size_t k = 0; k < block.height; ++k) {
                std::copy_n(block.row(k), block.width * n,
                            next.row(row / halving + k) + column / halving * n);
            }
        });
        summed.push_back(firstErrors(encoded, errors, topOf(band)));
        return next;
    }

    static LevelErrors firstErrors(const std::vector<EncodedTexels>& encoded,
                                   const LevelTexels& errors, std::size_t top) {
        EncodedTexels all;
        for (const EncodedTexels& part : encoded) {
            if (!part.finite) refuse(top, part.largest);
            all.largest = std::max(all.largest, part.largest);
        }
        std::vector<EncodedTexels> rows(errors.height);
        for (std::size_t row = 0; row < errors.height; ++row) {
            rows[row].errors.assign(errors.row(row), errors.row(row) + errors.width);
            rows[row].largest = all.largest;
        }
        return LevelWriter::errorsOfRows(rows, top);
    }

    TexelSource& source_;
    const TexelEncoder& encoder_;
    LevelFile& file_;
    const BandPlan& plan_;
    std::vector<LevelSize> sizes_;  ///< as if there were all levels
    std::size_t writtenLevels_;     ///< by bands
    std::size_t pictureLevel_;
};

}  // namespace

BandPlan planBands(const std::vector<LevelSize>& sizes, std::size_t bytesOfTexel,
                   std::size_t memory) {
    const auto [width, height] = sizes.front();
    const std::size_t fit = std::max<std::size_t>(memory / (width * bytesOfTexel), 1);
    constexpr std::size_t mostRows = 256;
    const std::size_t wanted = std::min({fit, mostRows, height});
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

MapWritten writeMap(TexelSource& source, const TexelEncoder& encoder, LevelFile& file,
                    const BandPlan& plan, BandDealer& dealer, const MapWriterOptions& options) {
    MapWork work(source, encoder, file, plan, options);
    if (dealer.isFirst()) file.begin();
    std::map<std::size_t, std::vector<float>> results;
    std::size_t done = 0;
    // One band is read and one is written while one is computed.
    const auto reading = [&](std::optional<std::size_t> band) {
        if (!band) return std::future<std::unique_ptr<TexelBand>>();
        return std::async(std::launch::async,
                          [&, b = *band] { return source.band(work.topOf(b), work.bottomOf(b)); });
    };
    std::optional<std::size_t> band = dealer.next();
    auto read = reading(band);
    std::vector<std::byte> buffers[2];  // one is filled while the other is written
    std::future<void> writing;          // ends before the buffers do, also after an exception
    while (band) {
        const std::unique_ptr<TexelBand> texels = read.get();
        const std::size_t current = *band;
        band = dealer.next();
        read = reading(band);
        std::vector<std::byte>& bytes = buffers[done % 2];
        results[current] = work.levelsOf(current, *texels, bytes).floats();
        if (writing.valid()) writing.get();
        writing = std::async(std::launch::async, [&, current] {
            file.write(0, work.topOf(current), work.bottomOf(current) - work.topOf(current), bytes);
        });
        ++done;
        if (options.progress) options.progress(done, plan.count);
    }
    if (writing.valid()) writing.get();
    dealer.collect(results);
    return dealer.isFirst() ? work.finished(results) : MapWritten{};
}

}  // namespace hshfit::inline material_maps
