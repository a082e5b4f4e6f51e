#pragma once

#include <hshfit/normal_filtering/mip_errors.h>
#include <hshfit/normal_filtering/mip_parts.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::inline normal_filtering {

/// A texel of a level, row * width + column.
struct MipPlace {
    int level;
    std::size_t index;
};

/// Gathers what the measurement of mip texels needs of their base texels while rows of the base
/// pass by, so that neither the base nor a level is held. Averages are sums of sums over blocks of
/// rows, so that processes that gather parts of the base come to the same bits as one.
class GatheredTexels {
public:
    /// Parts of the base that are gathered apart begin at multiples of so many rows.
    static constexpr std::size_t blockRows = 16;

    /// `samples`: base texels of each, one in each cell of its footprint; all where it has fewer.
    GatheredTexels(std::size_t width, std::size_t height, std::vector<MipPlace> places, int samples,
                   std::uint64_t seed = 1);

    /// A row of the base; rising rows.
    void add(std::size_t y, std::span<const SurfaceTexel> row);
    /// All that was gathered from some rows, which begin at a block and end at one or with the
    /// base.
    std::vector<SurfaceTexel> taken(const MipRows& rows) const;
    /// The number of these texels, and the inverse.
    std::size_t takenCount(const MipRows& rows) const;
    void put(const MipRows& rows, std::span<const SurfaceTexel> taken);
    /// To be called when all rows have been gathered.
    void finish();

    std::size_t size() const { return places_.size(); }
    const MipPlace& place(std::size_t k) const { return places_[k]; }
    /// After `finish`. Filtered numbers are the caller's.
    const MeasuredTexel& texel(std::size_t k) const { return texels_[k]; }
    MeasuredTexel& texel(std::size_t k) { return texels_[k]; }

private:
    struct Sample {
        std::size_t y, x;
    };
    struct Gathering {
        std::size_t x, y, width, height;
        std::vector<Sample> samples = {};       ///< in the order of rows
        std::vector<SurfaceTexel> blocks = {};  ///< sums over rows of each block, from y on

        std::size_t firstBlock() const { return y / blockRows; }
    };
    /// Calls each(block) and each(sample) for what rows have of gathering k, in a fixed order.
    template <class Block, class Sampled>
    void each(std::size_t k, const MipRows& rows, const Block& block, const Sampled& sample) const;

    std::size_t width_;
    std::vector<MipPlace> places_;
    std::vector<Gathering> gathering_;
    std::vector<MeasuredTexel> texels_;
};

}  // namespace hshfit::inline normal_filtering
