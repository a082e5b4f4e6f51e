#include <hshfit/material_maps/internal/tile_work.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::inline material_maps {

void ErrorSum::add(const EncodedRange& range, const std::vector<float>& of, std::size_t texels,
                   std::size_t row, std::size_t column) {
    ErrorSum row1{.count = texels, .finite = range.finite};
    row1.errors.largest = static_cast<double>(range.largest);
    for (std::size_t t = 0; t < texels; ++t) {
        const auto error = static_cast<double>(of[t]);
        row1.sum += error;
        if (error > row1.errors.maximum) {
            row1.errors.maximum = error;
            row1.errors.row = row;
            row1.errors.column = column + t;
        }
    }
    add(row1);
}

void ErrorSum::add(const ErrorSum& more) {
    sum += more.sum;
    count += more.count;
    finite = finite && more.finite;
    errors.largest = std::max(errors.largest, more.errors.largest);
    const auto before = [](const LevelErrors& a, const LevelErrors& b) {
        return a.row != b.row ? a.row < b.row : a.column < b.column;
    };
    // The first in the map of equal ones, in any order of tiles.
    if (more.errors.maximum > errors.maximum ||
        (more.errors.maximum == errors.maximum && errors.maximum > 0 &&
         before(more.errors, errors))) {
        errors.maximum = more.errors.maximum;
        errors.row = more.errors.row;
        errors.column = more.errors.column;
    }
}

LevelErrors ErrorSum::result(std::size_t firstRow) const {
    if (!finite) {
        throw NumericError(fmt::format(
            "from row {} on, a number of {:.3g} is not finite or beyond float16 (65504); store "
            "float32",
            firstRow, errors.largest));
    }
    LevelErrors result = errors;
    result.mean = sum / static_cast<double>(std::max<std::size_t>(count, 1));
    return result;
}

TileWork::TileWork(const TexelEncoder& encoder, std::size_t floatsOfTexel, std::size_t levels)
    : encoder_(encoder),
      floats_(floatsOfTexel),
      levels_(levels),
      rows_(side, encoder.linear(), levels),
      errors_(side) {
    if (!encoder.averagesTexels()) texels_.resize(side * floatsOfTexel);
}

std::vector<ErrorSum> TileWork::make(const TexelBand& texels, const Tile& tile,
                                     const BandTarget& band) {
    std::vector<ErrorSum> sums(levels_);
    const std::size_t n = encoder_.linear();
    rows_.reset(tile.columns);
    for (std::size_t row = 0; row < tile.rows; ++row) {
        float* next = rows_.next();
        float* from = encoder_.averagesTexels() ? next : texels_.data();
        texels.texels(band.top + tile.row + row, tile.column, tile.columns, from);
        for (std::size_t t = 0; from != next && t < tile.columns; ++t)
            encoder_.reduce(from + t * floats_, next + t * n);
        rows_.push([&](std::size_t level, std::size_t at, const float* linear) {
            const std::size_t width = tile.columns >> level, column = tile.column >> level;
            at += tile.row >> level;
            EncodedLevel& to = band.levels[level];
            const EncodedRange range = encoder_.encode(
                level, {linear, width * n}, {to.at(at, column), to.pitch(), errors_.data()});
            sums[level].add(range, errors_, width, (band.top >> level) + at, column);
            if (level == 0)
                std::copy_n(errors_.data(), width, band.errors + at * to.width + column);
            if (level + 1 == levels_ && band.topLevel)
                std::copy_n(linear, width * n, band.topLevel + (at * to.width + column) * n);
        });
    }
    return sums;
}

}  // namespace hshfit::inline material_maps
