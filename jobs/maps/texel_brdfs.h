#pragma once

#include "parameter_maps.h"

#include <hshfit/brdf/brdf.h>
#include <hshfit/material_maps/texel_source.h>

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// A texel of a level.
struct TexelPlace {
    std::size_t level = 0, column = 0, row = 0;
};

/// Texels of a level on an even grid, at most `most`, row by row.
std::vector<TexelPlace> spreadPlaces(const std::vector<LevelSize>& levels, std::size_t level,
                                     std::size_t most);

/// The specification of the BRDF at a column of a row of the maps.
std::string specificationOf(const ParameterMaps& maps, const std::vector<float>& row,
                            std::size_t column);

/// The BRDF of a texel: specifications with their shares, which add up to 1.
using SpecShares = std::map<std::string, double>;

/// The BRDFs that texels stand for. In level 0 it is the BRDF of the parameters that the maps have
/// there. In other levels it is the mean over the texels of level 0 below, or over `most` of them
/// at most, on an even grid. Rows are read in their order. Throws InputError.
std::vector<SpecShares> brdfsOfTexels(ParameterMaps& maps, const std::vector<LevelSize>& levels,
                                      const std::vector<TexelPlace>& places, std::size_t most);

/// The sum of them.
std::unique_ptr<Brdf> openShares(const SpecShares& shares);

}  // namespace hshfit::jobs
