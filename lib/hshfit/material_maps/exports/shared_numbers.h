#pragma once

#include <hshfit/gpu/texels.h>
#include <hshfit/material_maps/map_sidecar.h>

#include <cstddef>
#include <string>

namespace hshfit::inline material_maps::inline exports {

/// Numbers that the texels of a map share, as a second texture of float32: quadruple n is texel
/// (n % width, n / width) of one layer. Shapes come first: outgoing direction o has G quadruples
/// from o G on, G = ceil(rank slots / 4), and number r * slots + slot of them belongs to shape r.
/// For the form clusters the materials follow, M = ceil(channels rank / 4) quadruples each, and
/// number channel * rank + r of them is the weight of shape r.
struct SharedNumbers {
    static constexpr int width = 1024, mostRows = 2048;  ///< rows: as many as WebGL 2 promises
    std::size_t groupsOfShapes = 0;                      ///< G
    std::size_t groupsOfMaterial = 0;                    ///< M
    std::size_t firstMaterial = 0;                       ///< quadruple
    gpu::Texels texels = {};
};

/// Throws UsageError for a map of the form outgoing, which has none, and for more numbers than a
/// texture of that width and height has.
SharedNumbers sharedNumbers(const MapSidecar& map);

}  // namespace hshfit::inline material_maps::inline exports
