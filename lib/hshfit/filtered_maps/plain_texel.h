#pragma once

#include <hshfit/normal_filtering/mip_errors.h>

#include <span>

namespace hshfit::inline filtered_maps {

/// f cos(theta_i) of a texel of level 0: its model in its own frame, 0 below its horizon.
/// `numbers` are laid out as MipLayout says.
class PlainTexel {
public:
    PlainTexel(const FilteredSurface& surface, const MipLayout& layout, const FilteredTexel& texel,
               std::span<const double> numbers);

    void reflect(const Direction& wi, const Direction& wo, std::span<double> out) const;

private:
    const FilteredSurface& surface_;
    SurfaceTexel texel_;
};

}  // namespace hshfit::inline filtered_maps
