#pragma once

#include <hshfit/material_maps/exports/map_sampler.h>
#include <hshfit/material_maps/material_map.h>

#include <memory>
#include <string>
#include <vector>

namespace hshfit::test {

/// A map of noise: neighbouring texels have nothing in common, so that a wrong texel, level or
/// share shows.
struct SampleMap {
    std::string name;
    std::string form = "outgoing";
    std::string basis = "hsh";
    int order = 4;
    std::string outgoing = "5";
    bool grey = false, mirror = true;
    Quantity quantity = Quantity::brdf;
    gpu::Number number = gpu::Number::float16;
    std::size_t width = 16, height = 8, rank = 5, clusters = 7;
    Wrap wrap = Wrap::clamp;
};
std::vector<SampleMap> sampleMaps();

/// Writes material.json and material.ktx2 to a folder that stands, and opens them.
std::unique_ptr<MaterialMap> writeSampleMap(const SampleMap& sample, const std::string& folder);

}  // namespace hshfit::test
