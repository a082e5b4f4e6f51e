#pragma once

#include <hshfit/filtered_maps/filtered_map.h>
#include <hshfit/material_maps/exports/map_sampler.h>
#include <hshfit/normal_filtering/mip_errors.h>

#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline filtered_maps::inline exports {

/// f cos(theta_i) between the texels of a map of filtered lobes, in double precision: what a shader
/// has to give.
///
/// The moments of texels are means, and are blended by the shares of `mapCorners`. From level 1 on
/// a place is a FilteredTexel of the blended moments. A place of level 0 is its model in the frame
/// of the blended normal and direction, and a place between these levels the mean of both by its
/// level.
class FilteredSampler {
public:
    /// `surface` has f and its parts for texels of the map, `table` the lobes, of the order of the
    /// map's harmonics. The map outlives this object.
    FilteredSampler(const FilteredMap& map, FilteredSurface surface,
                    std::shared_ptr<const LobeTable> table, Wrap wrap);

    /// f cos(theta_i) by channel. Directions below the horizon give 0. Throws InputError.
    std::vector<double> value(const MapPlace& place, const Direction& wo,
                              const Direction& wi) const;
    /// The tests of mapTests().
    std::vector<MapTest> tests() const;

private:
    void add(double share, double level, const MapPlace& place, const Direction& wo,
             const Direction& wi, std::span<double> out) const;

    const FilteredMap& map_;
    FilteredSurface surface_;
    std::shared_ptr<const LobeTable> table_;
    std::shared_ptr<const Basis> basis_;
    Wrap wrap_;
};

}  // namespace hshfit::inline filtered_maps::inline exports
