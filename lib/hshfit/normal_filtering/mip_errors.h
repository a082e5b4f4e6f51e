#pragma once

#include <hshfit/normal_filtering/filtered_texel.h>
#include <hshfit/normal_filtering/mip_filter.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline normal_filtering {

/// The base level and its reflectance.
struct FilteredSurface {
    std::size_t width = 0, height = 0;
    std::function<SurfaceTexel(std::size_t x, std::size_t y)> texel;
    /// f in 1/sr of a texel in its own frame, by channel; both directions above its horizon.
    std::function<void(const SurfaceTexel&, const Direction& wi, const Direction& wo,
                       std::span<double> out)>
        brdf;
    /// The same without D, see FilteredTexel.
    FilteredTexel::Rest rest;
    int channels = 3;
};

struct MipErrorOptions {
    /// Base texels of the truth, one in each cell of the footprint; all where it has fewer.
    int samples = 1024;
    int texels = 8;     ///< mip texels, spread over the level
    int outgoing = 16;  ///< from the normal to 88 degrees
    int incoming = 64;  ///< half of them about the mirror direction, half over the hemisphere
    std::uint64_t seed = 1;
    std::vector<int> orders = {};  ///< of harmonics; empty: that of the layout
};

/// The distance of a form from the average of f cos(theta_i) cos(theta_o) over base texels, for the
/// cosines at each texel's own normal and 0 below its horizon.
struct MipError {
    std::string form;         ///< "parameters", "harmonics", "ellipse"
    int order = 0;            ///< of harmonics
    std::size_t numbers = 0;  ///< of a texel
    double relative = 0;  ///< L2 over both hemispheres and all mip texels, over the truth's norm
    /// Largest difference, over the largest true value of that mip texel, and its place.
    double maximum = 0;
    Direction wi = {}, wo = {};
    double albedo = 1;  ///< hemispherical albedo over the true one
    /// Of the outgoing directions of all mip texels, the one whose albedo is furthest off.
    double worstAlbedo = 1;
};
struct MipErrors {
    std::vector<MipError> forms;
    /// Relative L2 standard error of the truth, 0 where it has all texels of the footprint.
    double noise = 0;
};

/// Errors of all forms of one level against the same truth; "parameters" are ordinary mips: mean
/// normal renormalised, mean tangent, lobe place, weights and albedos, in `brdf`.
MipErrors measureMipLevel(const FilteredSurface& surface, int level, const MipLevel& filtered,
                          const LobeTable& table, const MipErrorOptions& options = {});

}  // namespace hshfit::inline normal_filtering
