#include <hshfit/vector_targets.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/lighting/internal/pyramid_walk.cpp"
#include <hwy/foreach_target.h>

#include <hshfit/lighting/internal/light_pyramid.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::lighting {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 8>;
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());
/// Vectors that hold the numbers of all axes.
constexpr std::size_t parts = LightPyramid::axesAtOnce / lanes;

struct Masks {
    Mask of[parts];
};

/// Four axes on their way through the pyramid.
class Walk {
public:
    Walk(const LightPyramid& pyramid, const LightPyramid::Axes& axes, const PyramidKernel& kernel)
        : pyramid_(pyramid), kernel_(kernel) {
        const Tag d;
        for (std::size_t p = 0; p < parts; ++p) {
            double x[lanes], y[lanes], z[lanes];
            for (std::size_t k = 0; k < lanes; ++k) {
                const Direction& axis = axes[p * lanes + k];
                x[k] = axis.x, y[k] = axis.y, z[k] = axis.z;
            }
            x_[p] = hn::LoadU(d, x), y_[p] = hn::LoadU(d, y), z_[p] = hn::LoadU(d, z);
            for (Vec& sum : sums_[p]) sum = hn::Zero(d);
        }
    }

    void all() {
        const Tag d;
        Masks every;
        for (Mask& mask : every.of) mask = hn::FirstN(d, lanes);
        for (std::size_t face = 0; face < 6; ++face)
            add(pyramid_.levels.size() - 1, face, 0, 0, every);
    }

    void addTo(LightPyramid::Sums& sums) const {
        const Tag d;
        for (std::size_t p = 0; p < parts; ++p) {
            for (std::size_t c = 0; c < 3; ++c) {
                double values[lanes];
                hn::StoreU(sums_[p][c], d, values);
                for (std::size_t k = 0; k < lanes; ++k) sums[p * lanes + k][c] += values[k];
            }
        }
    }

private:
    using Cell = LightPyramid::Cell;

    HWY_INLINE Vec cosine(std::size_t p, const Cell& cell) const {
        const Tag d;
        const Vec x = hn::Mul(x_[p], hn::Set(d, cell.sum.x)),
                  y = hn::Mul(y_[p], hn::Set(d, cell.sum.y)),
                  z = hn::Mul(z_[p], hn::Set(d, cell.sum.z));
        return hn::Add(hn::Add(x, y), z);
    }

    /// The kernel as LobeKernel::Scaled::at has it, times the flux, where the mask is set.
    HWY_INLINE void addNode(std::size_t p, Vec cosine, const Cell& node, Mask mask) {
        const Tag d;
        const hn::RebindToSigned<Tag> whole;
        const auto last = static_cast<double>(kernel_.table.size() - 1);
        const Vec half = hn::Mul(hn::Sub(hn::Set(d, 1.0), cosine), hn::Set(d, 0.5));
        const Vec inside = hn::Min(hn::Max(half, hn::Zero(d)), hn::Set(d, 1.0));
        const Vec place = hn::Mul(hn::Sqrt(inside), hn::Set(d, last));
        const Vec below = hn::Min(hn::Floor(place), hn::Set(d, last - 1));
        const auto at = hn::ConvertTo(whole, below);
        const Vec low = hn::GatherIndex(d, kernel_.table.data(), at),
                  high = hn::GatherIndex(d, kernel_.table.data() + 1, at);
        const Vec between = hn::Mul(hn::Sub(place, below), hn::Sub(high, low));
        const Vec weight = hn::IfThenElseZero(mask, hn::Add(low, between));
        for (std::size_t c = 0; c < 3; ++c)
            sums_[p][c] = hn::Add(sums_[p][c], hn::Mul(weight, hn::Set(d, node.flux[c])));
    }

    void addNode(const Cell& node, const Masks& masks) {
        for (std::size_t p = 0; p < parts; ++p) addNode(p, cosine(p, node), node, masks.of[p]);
    }

    /// A cell for the axes of the mask: as one node for those that it is slender for, its parts for
    /// the others.
    void add(std::size_t level, std::size_t face, std::size_t row, std::size_t column,
             const Masks& masks) {
        const Tag d;
        const LightPyramid::Level& own = pyramid_.levels[level];
        const std::size_t place = (face * own.width + row) * own.width + column;
        const Cell& cell = own.cells[place];
        if (!cell.any) return;
        const double size = 2 / static_cast<double>(own.width);
        const Vec least = hn::Set(d, size * size / (LightPyramid::slender * LightPyramid::slender));
        const Vec core = hn::Set(d, 1 / (kernel_.core * kernel_.core));
        Masks rest;
        bool others = false;
        for (std::size_t p = 0; p < parts; ++p) {
            const Vec cosines = cosine(p, cell);
            // The square of the chord.
            const Vec squared = hn::Sub(hn::Set(d, 2.0), hn::Mul(hn::Set(d, 2.0), cosines));
            const Vec growth =
                hn::Min(hn::Max(hn::Mul(squared, core), hn::Set(d, 1.0)), hn::Set(d, 16.0));
            const Mask slender = hn::Le(least, hn::Mul(squared, growth));
            const Mask here = hn::And(slender, masks.of[p]);
            rest.of[p] = hn::AndNot(slender, masks.of[p]);
            if (!hn::AllFalse(d, here)) addNode(p, cosines, cell, here);
            others = others || !hn::AllFalse(d, rest.of[p]);
        }
        if (others) addParts(level, face, row, column, rest);
    }

    void addParts(std::size_t level, std::size_t face, std::size_t row, std::size_t column,
                  const Masks& masks) {
        const std::vector<std::size_t>& first = pyramid_.first;
        const std::size_t own = pyramid_.levels[level].width;
        const std::size_t place = (face * own + row) * own + column;
        if (level == 0 && first.empty()) return addNode(pyramid_.levels[0].cells[place], masks);
        if (level == 0) {
            for (std::size_t k = first[place]; k < first[place + 1]; ++k)
                addNode(pyramid_.nodes[k], masks);
            return;
        }
        const std::size_t width = pyramid_.levels[level - 1].width;
        for (std::size_t j = 2 * row; j < std::min(width, 2 * row + 2); ++j)
            for (std::size_t i = 2 * column; i < std::min(width, 2 * column + 2); ++i)
                add(level - 1, face, j, i, masks);
    }

    const LightPyramid& pyramid_;
    const PyramidKernel& kernel_;
    Vec x_[parts], y_[parts], z_[parts], sums_[parts][3];
};

void addByAxes(const LightPyramid& pyramid, const LightPyramid::Axes& axes,
               const PyramidKernel& kernel, LightPyramid::Sums& sums) {
    Walk walk(pyramid, axes, kernel);
    walk.all();
    walk.addTo(sums);
}

}  // namespace HWY_NAMESPACE
}  // namespace hshfit::lighting
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::lighting {
namespace {
HWY_EXPORT(addByAxes);
}

void LightPyramid::add(const Axes& axes, const PyramidKernel& kernel, Sums& sums) const {
    HWY_DYNAMIC_DISPATCH(addByAxes)(*this, axes, kernel, sums);
}

}  // namespace hshfit::lighting
#endif
