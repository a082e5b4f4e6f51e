#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/material_maps/exports/map_shader.h>
#include <hshfit/material_maps/material_map.h>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline material_maps::inline exports {

/// A place of a map: u to the right and v downwards, in [0, 1], and a level, whole or between two.
struct MapPlace {
    double u = 0.5, v = 0.5, level = 0;
};

/// The texels around a place with their shares, as linear filters blend them: up to four of each of
/// two levels. Shares add up to 1.
struct MapCorner {
    std::size_t level = 0, column = 0, row = 0;
    double share = 0;
};
std::vector<MapCorner> mapCorners(std::span<const LevelSize> levels, const MapPlace& place,
                                  Wrap wrap);

/// q(wo, wi) at a place, per channel, not clamped, in double precision: what a shader has to give.
/// Throws InputError.
std::vector<double> mapValue(const MaterialMap& map, const MapPlace& place, Wrap wrap,
                             const Direction& wo, const Direction& wi);

/// A place with directions and the values there, for readers of an export to check themselves by.
struct MapTest {
    MapPlace place;
    Direction wo, wi;
    std::vector<double> value;
};
/// The 72 pairs of gpu::testPairs(), a third of them at centres of texels, a third anywhere on
/// level 0 and a third between levels, with values by `value`. Places are exact in float32.
using MapValue = std::function<std::vector<double>(const MapPlace& place, const Direction& wo,
                                                   const Direction& wi)>;
std::vector<MapTest> mapTests(std::span<const LevelSize> levels, const MapValue& value);
std::vector<MapTest> mapTests(const MaterialMap& map, Wrap wrap);

}  // namespace hshfit::inline material_maps::inline exports
