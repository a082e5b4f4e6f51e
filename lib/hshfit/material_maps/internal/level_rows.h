#pragma once

#include <hshfit/material_maps/texel_kernel.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline material_maps {

/// Takes the rows of level 0 of a tile one after another, and makes the rows of the further levels,
/// which are means, each as soon as it is known. Two rows of each level are kept, which stay in a
/// processor's cache.
class LevelRows {
public:
    /// `step` floats a texel.
    LevelRows(std::size_t width, std::size_t step, std::size_t levels)
        : step_(step), counts_(levels) {
        for (std::size_t level = 0; level < levels; ++level)
            rows_.emplace_back(2 * (width >> level) * step);
        reset(width);
    }
    /// Begins another tile, whose `width` is no larger than before and, for several levels, a
    /// multiple of 2^(levels - 1).
    void reset(std::size_t width) {
        width_ = width;
        counts_.assign(counts_.size(), 0);
    }

    /// The place of the next row of level 0.
    float* next() { return row(0, counts_[0]); }
    /// The row at next() is written: calls visit(level, row, texels) for it and for every row of
    /// means that it completes.
    template <class Visit>
    void push(const Visit& visit) {
        for (std::size_t level = 0; level < counts_.size(); ++level) {
            const std::size_t now = counts_[level]++;
            visit(level, now, row(level, now));
            if (now % 2 == 0 || level + 1 == counts_.size()) return;
            meanOfFour(row(level, now - 1), row(level, now), width_ >> (level + 1), step_,
                       row(level + 1, counts_[level + 1]));
        }
    }

private:
    float* row(std::size_t level, std::size_t number) {
        return rows_[level].data() + number % 2 * (width_ >> level) * step_;
    }

    std::size_t width_ = 0, step_;
    std::vector<std::size_t> counts_;       ///< rows of each level that are known
    std::vector<std::vector<float>> rows_;  ///< [level][row % 2][column][step]
};

}  // namespace hshfit::inline material_maps
