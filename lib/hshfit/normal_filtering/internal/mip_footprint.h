#pragma once

#include <hshfit/brdf/vectors.h>
#include <hshfit/normal_filtering/mip_layout.h>

#include <cstddef>

namespace hshfit::inline normal_filtering {

/// The base texels of a mip texel: from, and how many.
struct Footprint {
    std::size_t x, y, width, height;
    std::size_t count() const { return width * height; }
};

/// The footprint of texel `index` of a level of `across` x `down` texels.
inline Footprint footprintOf(std::size_t width, std::size_t height, std::size_t across,
                             std::size_t down, std::size_t index) {
    const std::size_t x = index % across, y = index / across;
    const std::size_t left = x * width / across, top = y * height / down;
    return {left, top, (x + 1) * width / across - left, (y + 1) * height / down - top};
}

/// Adds a share of a texel to averaged parameters.
inline void addToMean(const SurfaceTexel& t, double share, SurfaceTexel& mean) {
    mean.normal = mean.normal + share * normalised(t.normal);
    mean.tangent = mean.tangent + share * t.tangent;
    for (std::size_t i = 0; i < 2; ++i) mean.lobe[i] += share * t.lobe[i];
    for (std::size_t i = 0; i < SurfaceTexel::most; ++i) {
        mean.weights[i] += share * t.weights[i];
        mean.albedos[i] += share * t.albedos[i];
    }
}
/// Adds a part of averaged parameters.
inline void addSum(const SurfaceTexel& part, SurfaceTexel& mean) {
    mean.normal = mean.normal + part.normal;
    mean.tangent = mean.tangent + part.tangent;
    for (std::size_t i = 0; i < 2; ++i) mean.lobe[i] += part.lobe[i];
    for (std::size_t i = 0; i < SurfaceTexel::most; ++i) {
        mean.weights[i] += part.weights[i];
        mean.albedos[i] += part.albedos[i];
    }
}
/// The mean before anything is added to it.
inline SurfaceTexel noTexel() {
    SurfaceTexel mean;
    mean.normal = mean.tangent = {0, 0, 0};
    mean.weights = {};
    return mean;
}

}  // namespace hshfit::inline normal_filtering
