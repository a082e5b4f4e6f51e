#pragma once

#include <hshfit/normal_filtering/mip_errors.h>

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
/// stream by, so that neither the base nor a level is held.
class GatheredTexels {
public:
    /// `samples`: base texels of each, one in each cell of its footprint; all where it has fewer.
    GatheredTexels(std::size_t width, std::size_t height, std::vector<MipPlace> places, int samples,
                   std::uint64_t seed = 1);

    /// The next row of the base.
    void add(std::span<const SurfaceTexel> row);

    std::size_t size() const { return places_.size(); }
    const MipPlace& place(std::size_t k) const { return places_[k]; }
    /// After the last row. Filtered numbers are the caller's.
    const MeasuredTexel& texel(std::size_t k) const { return texels_[k]; }
    MeasuredTexel& texel(std::size_t k) { return texels_[k]; }

private:
    struct Sample {
        std::size_t y, x;
    };
    struct Gathering {
        std::size_t x, y, width, height;
        std::vector<Sample> samples = {};  ///< in the order of rows
        std::size_t next = 0;
    };
    std::size_t width_, row_ = 0;
    std::vector<MipPlace> places_;
    std::vector<Gathering> gathering_;
    std::vector<MeasuredTexel> texels_;
};

}  // namespace hshfit::inline normal_filtering
