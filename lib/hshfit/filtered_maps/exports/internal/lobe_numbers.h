#pragma once

#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/gpu/texels.h>

#include <cstddef>

namespace hshfit::inline filtered_maps::inline exports {

/// The lobes of a map at its nodes, as a texture of float32: quadruple n is texel (n % width,
/// n / width) of one layer. First, for each node [row][column], widths along x and y and the two
/// parameters there; then, for each, `gaussians` quadruples (peak, variance, 0, 0) of D as a
/// GaussianSum; the ones that a node does not use have a peak of 0.
struct LobeNumbers {
    std::size_t rows = 1, columns = 1, gaussians = 0;
    gpu::Texels texels = {};

    std::size_t nodes() const { return rows * columns; }
};

/// The numbers of the lobes that the sidecar of a map states.
LobeNumbers lobeNumbers(const FilteredSidecar& map);

}  // namespace hshfit::inline filtered_maps::inline exports
