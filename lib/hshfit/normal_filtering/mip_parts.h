#pragma once

#include <cstddef>

namespace hshfit::inline normal_filtering {

/// Texels along one side of a level: base / 2^level, rounded down, at least 1.
constexpr std::size_t mipSize(std::size_t base, int level) {
    const std::size_t size = base >> level;
    return size == 0 ? 1 : size;
}
/// Levels beyond the base until 1 x 1.
int mipLevels(std::size_t width, std::size_t height);

/// Rows [first, last).
struct MipRows {
    std::size_t first = 0, last = 0;
};

/// A part of a surface: rows `top` of level `level`, and what stands below them.
struct MipPart {
    std::size_t height = 1;  ///< of the base
    int level = 0;
    MipRows top = {0, 1};

    /// Rows of a level, at most `level`, that belong to the part: each to one part alone.
    MipRows own(int of) const;
    /// Rows that have to be known for them. Where a side is odd, these go on into the next part: by
    /// fewer than 2^level rows of the base.
    MipRows needed(int of) const;
};

/// A surface in parts that can be filtered apart, for processes that share the work. Parts do not
/// change a bit of the rows of levels.
class MipParts {
public:
    /// One part: all levels.
    MipParts(std::size_t width, std::size_t height);
    /// As many parts as asked for, or fewer. The numbers of the last level that parts complete are
    /// held by one process, which makes the levels above: `held` at most, unless the surface has
    /// one part. With odd sides, a part has at least four times the rows that it needs of another.
    /// Parts begin at multiples of `step` rows of the base, a power of 2.
    MipParts(std::size_t width, std::size_t height, std::size_t parts, std::size_t numbersOfTexel,
             std::size_t held, std::size_t step);

    std::size_t count() const { return count_; }
    int level() const { return level_; }  ///< the last one that parts complete
    MipPart part(std::size_t k) const;

private:
    std::size_t width_, height_, count_ = 1, rows_ = 1;  ///< rows_ of `level_` in a part
    int level_ = 0;
};

}  // namespace hshfit::inline normal_filtering
