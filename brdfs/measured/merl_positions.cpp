#include <brdfs/measured/merl_positions.h>

#include <algorithm>
#include <cmath>

#define HWY_TARGET_INCLUDE "brdfs/measured/merl_position_lanes.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {

HWY_EXPORT(merlIndices);
HWY_EXPORT(merlCorners);
HWY_EXPORT(merlBlend);

void MerlIndices::set(const Direction& wo, DirectionBatch wi, const MerlLayout& layout) {
    HWY_DYNAMIC_DISPATCH(merlIndices)(wo, wi, layout.azimuthCount == 180, *this);
}

void MerlIndices::round(std::size_t count, std::size_t azimuths) {
    for (std::size_t k = 0; k < count; ++k) {
        h[k] = std::min(std::floor(h[k] + 0.5), 89.0);
        d[k] = std::min(std::floor(d[k] + 0.5), 89.0);
        p[k] = static_cast<double>(static_cast<std::size_t>(p[k] + 0.5) % azimuths);
    }
}

void MerlCorners::set(const MerlIndices& at, std::size_t count, const MerlLayout& layout) {
    HWY_DYNAMIC_DISPATCH(merlCorners)
    (at, count, static_cast<double>(layout.azimuthCount), *this);
}

std::uint64_t MerlCorners::blend(const unsigned char* cells, const MerlLayout& layout,
                                 const double* z, std::size_t count, double* out,
                                 std::size_t stride) const {
    return HWY_DYNAMIC_DISPATCH(merlBlend)(cells, layout.cells() * sizeof(double), *this, z, count,
                                           out, stride);
}

}  // namespace hshfit::brdfs
