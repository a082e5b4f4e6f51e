#include <brdfs/measured/bsdf_xml/data_cursor.h>
#include <brdfs/measured/bsdf_xml/tensor_tree.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

/// Recursive descent; a tree is at most maxLevels deep.
class TensorTree::Parser {
public:
    Parser(TensorTree& tree, const BsdfDocument& document, const BsdfBlock& block)
        : tree_(tree), cursor_(document, block) {}

    void parse() {
        tree_.root_ = parseTree(0);
        if (cursor_.next() != 0) {
            throw cursor_.error(fmt::format("{} after the tensor tree", cursor_.found()));
        }
        tree_.corruptOffset_ = cursor_.corruptOffset();
    }

private:
    std::size_t children() const { return std::size_t{1} << tree_.rank_; }

    void expect(char brace) {
        if (cursor_.next() != brace) {
            throw cursor_.error(fmt::format("{} in a tensor tree of rank {}, expected '{}'",
                                            cursor_.found(), tree_.rank_, brace));
        }
        cursor_.skip();
    }

    Reference parseTree(int level) {
        expect('{');
        const Reference result = cursor_.next() == '{' ? parseBranch(level) : parseValues(level);
        expect('}');
        cursor_.skipComma();
        return result;
    }

    Reference parseBranch(int level) {
        if (level >= maxLevels) throw tooDeep();
        const std::size_t first = allocate();
        for (std::size_t k = 0; k < children(); ++k) {
            if (cursor_.next() != '{') {
                throw cursor_.error(fmt::format("{} after {} trees of a branch, expected {} trees",
                                                cursor_.found(), k, children()));
            }
            const Reference child = parseTree(level + 1);
            tree_.nodes_[first + k] = child;
        }
        return static_cast<Reference>(first);
    }

    Reference parseValues(int level) {
        std::vector<double> grid;
        const std::size_t start = cursor_.offset();
        for (double value = 0; cursor_.take(value);) grid.push_back(value);
        int steps = 0;
        while (steps < maxLevels && (std::size_t{1} << (tree_.rank_ * steps)) < grid.size())
            ++steps;
        if ((std::size_t{1} << (tree_.rank_ * steps)) != grid.size()) {
            throw cursor_.errorAt(
                start,
                fmt::format("{} values between braces, expected 1, {} or another power of {}",
                            grid.size(), children(), children()));
        }
        if (level + steps > maxLevels) throw tooDeep();
        return spread(grid, level, steps, {}, 1 << steps);
    }

    /// A grid as branches and leaves: the cube at `corner`, `width` steps of the grid wide.
    Reference spread(const std::vector<double>& grid, int level, int steps,
                     const std::array<int, 4>& corner, int width) {
        tree_.levels_ = std::max(tree_.levels_, level);
        if (width == 1) {
            std::size_t index = 0;
            for (int i = 0; i < tree_.rank_; ++i) {
                index = (index << steps) + static_cast<std::size_t>(corner[i]);
            }
            tree_.values_.push_back(grid[index]);
            return -static_cast<Reference>(tree_.values_.size());
        }
        const std::size_t first = allocate();
        for (std::size_t k = 0; k < children(); ++k) {
            std::array<int, 4> part = corner;
            for (int i = 0; i < tree_.rank_; ++i) part[i] += (k >> i & 1) != 0 ? width / 2 : 0;
            const Reference child = spread(grid, level + 1, steps, part, width / 2);
            tree_.nodes_[first + k] = child;
        }
        return static_cast<Reference>(first);
    }

    // A file is at most 1 GiB, and a value takes two bytes of it: indices fit in 31 bits.
    std::size_t allocate() {
        const std::size_t first = tree_.nodes_.size();
        tree_.nodes_.resize(first + children());
        return first;
    }
    InputError tooDeep() const {
        return cursor_.error(fmt::format("a tensor tree of more than {} levels", maxLevels));
    }

    TensorTree& tree_;
    DataCursor cursor_;
};

TensorTree::TensorTree(const BsdfDocument& document, const BsdfBlock& block, int rank)
    : rank_(rank) {
    Parser(*this, document, block).parse();
}

std::size_t TensorTree::leafAt(const Point& point) const {
    constexpr double scale = 1 << maxLevels;
    constexpr std::uint32_t last = (1u << maxLevels) - 1;
    std::uint32_t position[4] = {};
    for (int i = 0; i < rank_; ++i) {
        const double scaled = std::min(std::max(point[i] * scale, 0.0), static_cast<double>(last));
        position[i] = static_cast<std::uint32_t>(scaled);
    }
    Reference at = root_;
    for (int bit = maxLevels - 1; at >= 0; --bit) {
        std::uint32_t child = 0;
        for (int i = 0; i < rank_; ++i) child |= (position[i] >> bit & 1u) << i;
        at = nodes_[static_cast<std::size_t>(at) + child];
    }
    return static_cast<std::size_t>(-1 - at);
}

double TensorTree::at(const Point& point) const {
    return values_[leafAt(point)];
}

// Every leaf adds its share to the grid of its own width; then each grid is added to the next
// finer one. A wide leaf therefore costs no more than a narrow one.
std::vector<double> TensorTree::averages(int firstKept, int kept) const {
    std::vector<std::vector<double>> grids;
    for (int level = 0; level <= levels_; ++level) {
        grids.emplace_back(std::size_t{1} << (kept * level), 0.0);
    }
    forEachLeaf([&](const Leaf& leaf) {
        const int level = -std::ilogb(leaf.width);
        std::size_t index = 0;
        for (int i = kept; i-- > 0;) {
            const double step = leaf.corner[firstKept + i] / leaf.width;
            index = (index << level) + static_cast<std::size_t>(step);
        }
        grids[level][index] += values_[leaf.value] * std::pow(leaf.width, rank_ - kept);
    });
    for (int level = 1; level <= levels_; ++level) {
        const std::size_t side = std::size_t{1} << level;
        for (std::size_t index = 0; index < grids[level].size(); ++index) {
            std::size_t coarse = 0;
            for (int i = kept; i-- > 0;) {
                const std::size_t step = (index >> (i * level)) & (side - 1);
                coarse = (coarse << (level - 1)) + step / 2;
            }
            grids[level][index] += grids[level - 1][coarse];
        }
    }
    return grids.back();
}

std::vector<double> TensorTree::averagesOverLast(int over) const {
    return averages(0, rank_ - over);
}
std::vector<double> TensorTree::averagesOverFirst(int over) const {
    return averages(over, rank_ - over);
}

double TensorTree::asymmetry(const std::array<int, 4>& from,
                             const std::array<bool, 4>& flipped) const {
    double integral = 0;
    forEachLeaf([&](const Leaf& leaf) {
        integral += std::abs(values_[leaf.value]) * std::pow(leaf.width, rank_);
    });
    return integral > 0 ? difference(root_, root_, from, flipped) / integral : 0;
}

/// The integral of the absolute difference of two cubes, over their volume.
double TensorTree::difference(Reference a, Reference b, const std::array<int, 4>& from,
                              const std::array<bool, 4>& flipped) const {
    if (a < 0 && b < 0) return std::abs(values_[-1 - a] - values_[-1 - b]);
    double sum = 0;
    for (std::size_t k = 0; k < std::size_t{1} << rank_; ++k) {
        std::size_t image = 0;
        for (int i = 0; i < rank_; ++i) {
            const bool upper = (k >> from[i] & 1) != 0;
            image |= std::size_t{upper != flipped[i]} << i;
        }
        const Reference childA = a < 0 ? a : nodes_[static_cast<std::size_t>(a) + k];
        const Reference childB = b < 0 ? b : nodes_[static_cast<std::size_t>(b) + image];
        sum += difference(childA, childB, from, flipped);
    }
    return std::ldexp(sum, -rank_);
}

}  // namespace hshfit::brdfs
