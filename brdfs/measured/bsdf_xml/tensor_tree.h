#pragma once

#include <brdfs/measured/bsdf_xml/document.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hshfit::brdfs {

/// A function on the unit cube of 3 or 4 dimensions that is constant on each leaf of a tree: every
/// branch halves all dimensions (Ward, Mistrick, Lee, McNeil & Jonsson, "Simulating the Daylight
/// Performance of Complex Fenestration Systems Using Bidirectional Scattering Distribution
/// Functions within Radiance", Leukos 7(4), 2011).
///
/// As text: `{ v }` is a leaf, `{ t … t }` a branch with 2^rank trees, bit i of whose number says
/// which half of dimension i a tree stands for, and `{ v … v }` with 2^(rank n) values a grid of
/// 2^n steps in each dimension, the last of which changes fastest. Commas may stand between.
class TensorTree {
public:
    static constexpr int maxLevels = 10;  ///< the finest leaf is 1/1024 wide

    using Point = std::array<double, 4>;

    /// Throws InputError with the line for text that is no tree of that rank, for trees of more
    /// than `maxLevels`, and for leaves and branches of wrong size.
    TensorTree(const BsdfDocument& document, const BsdfBlock& block, int rank);

    int rank() const { return rank_; }
    int levels() const { return levels_; }  ///< the finest leaf is 2^-levels wide
    /// The values of the leaves, in no particular order; grids are split into leaves.
    const std::vector<double>& values() const { return values_; }
    std::vector<double>& values() { return values_; }
    /// Offset in the file of a value that is NaN or infinite; 0 if all are finite.
    std::size_t corruptOffset() const { return corruptOffset_; }

    /// Coordinates are clamped to [0, 1).
    double at(const Point& point) const;
    /// Index into values() of the leaf there.
    std::size_t leafAt(const Point& point) const;

    /// A leaf and the cube that it fills: [corner, corner + width) in every dimension.
    struct Leaf {
        std::size_t value = 0;
        Point corner{};
        double width = 1;
    };
    /// Calls visit(leaf) for every leaf.
    template <class Visit>
    void forEachLeaf(Visit visit) const;

    /// Averages over the last `over` (or the first) dimensions, on the finest grid of the others,
    /// first dimension fastest.
    std::vector<double> averagesOverLast(int over) const;
    std::vector<double> averagesOverFirst(int over) const;

    /// The asymmetry of the function when dimension i takes the place of `from[i]` and is reversed
    /// (u -> 1 - u) where `flipped[i]`: the integral of the absolute difference relative to the
    /// integral of the function. 0: it is exactly symmetric.
    double asymmetry(const std::array<int, 4>& from, const std::array<bool, 4>& flipped) const;

private:
    class Parser;
    /// A leaf -1 - value, or the first of 2^rank neighbouring entries of nodes_.
    using Reference = std::int32_t;
    double difference(Reference a, Reference b, const std::array<int, 4>& from,
                      const std::array<bool, 4>& flipped) const;
    std::vector<double> averages(int firstKept, int kept) const;

    int rank_ = 4, levels_ = 0;
    Reference root_ = -1;
    std::vector<Reference> nodes_;
    std::vector<double> values_;
    std::size_t corruptOffset_ = 0;
};

template <class Visit>
void TensorTree::forEachLeaf(Visit visit) const {
    struct Open {
        Reference at;
        Point corner;
        double width;
    };
    std::vector<Open> open{{root_, {}, 1}};
    while (!open.empty()) {
        const Open node = open.back();
        open.pop_back();
        if (node.at < 0) {
            visit(Leaf{static_cast<std::size_t>(-1 - node.at), node.corner, node.width});
            continue;
        }
        const double half = node.width / 2;
        for (std::size_t k = 0; k < std::size_t{1} << rank_; ++k) {
            Point corner = node.corner;
            for (int i = 0; i < rank_; ++i) corner[i] += (k >> i & 1) != 0 ? half : 0;
            open.push_back({nodes_[static_cast<std::size_t>(node.at) + k], corner, half});
        }
    }
}

}  // namespace hshfit::brdfs
