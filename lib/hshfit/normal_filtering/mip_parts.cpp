#include <hshfit/normal_filtering/mip_parts.h>

#include <hshfit/normal_filtering/internal/mip_box.h>

#include <algorithm>

namespace hshfit::inline normal_filtering {

int mipLevels(std::size_t width, std::size_t height) {
    int levels = 0;
    for (std::size_t size = std::max(width, height); size > 1; size /= 2) ++levels;
    return levels;
}

MipRows MipPart::own(int of) const {
    const int steps = level - of;
    const bool ends = top.last == mipSize(height, level);
    return {top.first << steps, ends ? mipSize(height, of) : top.last << steps};
}

MipRows MipPart::needed(int of) const {
    MipRows rows = top;
    for (int at = level; at-- > of;)
        rows = {own(at).first, boxOf(rows.last - 1, mipSize(height, at)).end()};
    return rows;
}

MipParts::MipParts(std::size_t width, std::size_t height)
    : width_(width), height_(height), level_(mipLevels(width, height)) {}

MipParts::MipParts(std::size_t width, std::size_t height, std::size_t parts,
                   std::size_t numbersOfTexel, std::size_t held, std::size_t step)
    : MipParts(width, height) {
    int level = 1;
    while ((width >> level) * (height >> level) * numbersOfTexel > held) ++level;
    // A part that is not the last begins at a multiple of 2^level and of `step`.
    const std::size_t whole = std::max(std::size_t{1} << level, step);
    std::size_t least = whole;
    for (int below = 0; below < level; ++below)
        if (mipSize(height, below) % 2 == 1) least = 4 * whole;
    std::size_t rows = std::max(least, (height + parts - 1) / std::max<std::size_t>(parts, 1));
    rows = (rows + whole - 1) / whole * whole;
    const std::size_t top = height >> level;
    if (parts < 2 || rows >= height || top < 2) return;
    level_ = level;
    rows_ = rows >> level;
    count_ = (top + rows_ - 1) / rows_;
}

MipPart MipParts::part(std::size_t k) const {
    const std::size_t first = k * rows_;
    return {height_, level_, {first, std::min(first + rows_, mipSize(height_, level_))}};
}

}  // namespace hshfit::inline normal_filtering
