#pragma once

#include <hshfit/gpu/forms/library_table.h>
#include <hshfit/library_maps/library_map.h>
#include <hshfit/material_maps/exports/map_sampler.h>

#include <string>
#include <vector>

namespace hshfit::inline library_maps::inline exports {

/// The functions of a map's basis as a table, and the error of f by it at up to 64 texels of level
/// 0 and one of each other level (gpu::tableError).
struct MapFunctions {
    gpu::SharedSums sums;
    gpu::TableError error;
};
/// The smallest table within `largest` (gpu::tabledWithin).
MapFunctions tabledFunctions(const LibraryMap& map, double largest = 0.1);

/// f at a place as a shader has to give it, by the table: q_k and bounds blended as linear filters
/// do, so that between texels f is a geometric mean of theirs.
std::vector<double> mapValue(const LibraryMap& map, const MapFunctions& functions,
                             const MapPlace& place, Wrap wrap, const Direction& wo,
                             const Direction& wi);

/// A snippet with the functions of `mapShader`, except its functions for light. Throws UsageError
/// for more layers than a language has.
std::string libraryMapShader(gpu::Language language, const LibraryMap& map,
                             const MapFunctions& functions, const MapShaderOptions& options);

}  // namespace hshfit::inline library_maps::inline exports
