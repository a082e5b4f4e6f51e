#pragma once

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/gpu/texels.h>
#include <hshfit/material_maps/map_writer.h>
#include <hshfit/material_maps/texel_layout.h>

#include <string>
#include <vector>

namespace hshfit::inline material_maps {

/// A map of materials as its JSON file states it, "hshfit-material-map" (docs/svbrdf.md).
struct MapSidecar {
    std::string form;  ///< "outgoing", "low-rank" or "clusters"
    std::string texture = {}, basis = {};
    int order = 0;
    Quantity quantity = Quantity::brdf;
    Channels channels = {};
    TexelLayout layout = {};
    bool isotropic = false, bilateral = false;
    gpu::Number number = gpu::Number::float16;
    std::vector<LevelSize> levels = {};
    std::vector<double> shapes = {};  ///< [rank][layout.shape()]; none of the form outgoing
    std::vector<float> centres = {};  ///< [cluster][channel * rank + r]; of the form clusters
    std::string source = {}, generator = {};

    std::size_t layers() const;
    std::size_t rank() const { return shapes.size() / layout.shape(); }
};

/// The file, on one line.
std::string toText(const MapSidecar& sidecar);
/// Throws InputError that starts with `file`.
MapSidecar readMapSidecar(const std::string& file);
/// Whether a file starts like one.
bool isMapSidecar(const std::string& file);

}  // namespace hshfit::inline material_maps
