#pragma once

#include <hshfit/normal_filtering/mip_layout.h>
#include <hshfit/normal_filtering/mip_parts.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline normal_filtering {

/// A finished row of a level, `width` texels of layout.size() numbers each.
struct MipRow {
    int level;  ///< from 1; level 0 is the base, which is not filtered
    std::size_t y, width;
    std::span<const double> texels;  ///< valid during the call alone
};

/// Mip levels of reflectance (Han, Sun, Ramamoorthi & Grinspun 2007, "Frequency domain normal map
/// filtering"): each texel contributes its D turned to its normal, as coefficients
///     c_(l,m) = w sqrt(4 pi / (2 l + 1)) d_l Y_(l,m)(n),
/// anisotropic D by rotation, and moments of its normal. Texels of all levels are box averages of
/// the level below, of two to three texels along a side of odd length. Texels count equally, as in
/// a renderer that takes many samples of a normal map.
///
/// Rows come in any portions and leave as soon as they are complete, so that at most three rows of
/// a level are held. The bits depend neither on the portions nor on the number of threads, nor on
/// the parts that a surface is filtered in.
class MipFilter {
public:
    using Sink = std::function<void(const MipRow&)>;
    /// The table has to have at least the order of the layout. Throws UsageError for a layout that
    /// is not allowed and for a size of 0.
    MipFilter(std::size_t width, std::size_t height, std::shared_ptr<const LobeTable> table,
              const MipLayout& layout, Sink sink);
    /// The rows of levels 1 to part.level that belong to a part, from its part.needed(0) of the
    /// base.
    MipFilter(std::size_t width, const MipPart& part, std::shared_ptr<const LobeTable> table,
              const MipLayout& layout, Sink sink);
    ~MipFilter();
    MipFilter(MipFilter&&) noexcept;
    MipFilter& operator=(MipFilter&&) noexcept;

    /// The next rows of the base, whole ones; the last one ends the work. Throws
    /// InputError with row and column for a number that is not finite, a normal of length 0, a
    /// tangent along the normal where the table is anisotropic, a negative weight or albedo, and
    /// for more rows than there are.
    void add(std::span<const SurfaceTexel> rows);
    /// The next row of a level that parts have made, for the levels above it. Of one level, and
    /// instead of rows of the base.
    void addRow(int level, std::vector<double> row);
    bool complete() const;

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

/// The numbers of unfiltered texels without harmonics: layout.ellipseSize() of each.
std::vector<double> ellipseNumbers(std::span<const SurfaceTexel> texels, const LobeTable& table,
                                   const MipLayout& layout);

/// A level in memory.
struct MipLevel {
    std::size_t width = 0, height = 0;
    MipLayout layout;
    std::vector<double> texels = {};
    std::span<const double> texel(std::size_t x, std::size_t y) const {
        return std::span(texels).subspan((y * width + x) * layout.size(), layout.size());
    }
};
/// All levels of a base in memory, level 1 first.
std::vector<MipLevel> filterNormals(std::size_t width, std::size_t height,
                                    std::span<const SurfaceTexel> base,
                                    std::shared_ptr<const LobeTable> table,
                                    const MipLayout& layout);

}  // namespace hshfit::inline normal_filtering
