#pragma once

#include <hshfit/material_library/log_space.h>

#include <array>
#include <span>
#include <vector>

namespace hshfit::material_library {

/// Materials as points of a plane.
struct Similarity {
    std::vector<double> distances;                   ///< `distance` of each two: [row][column]
    std::vector<std::array<double, 2>> coordinates;  ///< their mean is 0
    /// The share of the sum of all squared distances that the coordinates keep.
    double kept = 1;
};

/// Distances of all pairs, and classical multidimensional scaling to two coordinates (Torgerson
/// 1952): `distance` is Euclidean, so that these are the principal coordinates of the materials.
/// The first has the larger variance; signs are arbitrary. The digits do not depend on the number
/// of threads.
Similarity similarityOf(const LogSpace& space, std::span<const LogMaterial> materials);

/// Places of discs of diameter 1, none of which overlap, near the coordinates times a factor that
/// gives each disc twice its square of the bounding box. Discs that overlap push each other apart;
/// in the end all places are scaled until the nearest two touch. The least coordinates are 1/2.
std::vector<std::array<double, 2>> spreadPlaces(std::span<const std::array<double, 2>> coordinates);

}  // namespace hshfit::material_library
