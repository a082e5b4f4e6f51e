#pragma once

#include <hshfit/material_maps/material_map.h>
#include <hshfit/material_maps/reduction.h>
#include <hshfit/material_maps/texel_encoder.h>
#include <hshfit/material_maps/texel_layout.h>

#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline material_maps {

/// |a - b| / |b| of two texels [layout.floats()] in the norm of the layout,
///     |x|^2 = sum over outgoing directions of their solid angles times the squares of x
/// (Parseval), without unit; |a - b| where b is 0.
double relativeDistance(const TexelLayout& layout, std::span<const double> a,
                        std::span<const double> b);

/// A texel as a map stores it, in the order of its layout [layout.floats()]. Throws as
/// MaterialMap::coefficients does.
std::vector<double> storedTexel(const MaterialMap& map, std::size_t level, std::size_t column,
                                std::size_t row);

/// Errors of texels of level 0, linear[texel][encoder.linear()], as the encoder states them.
TexelErrors errorsOf(const TexelEncoder& encoder, std::span<const float> linear);

/// The least rank at which no texel errs by more than `most`, else the largest rank.
/// errors[rank - 1]
std::size_t leastRank(std::span<const TexelErrors> errors, double most);

}  // namespace hshfit::inline material_maps
