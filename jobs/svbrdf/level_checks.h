#pragma once

#include "model_lobes.h"
#include "svbrdf.h"

#include <hshfit/material_maps/material_map.h>

namespace hshfit::jobs {

/// Texels of every level of a written map against the texels that they stand for, and the same for
/// texels whose parameters are averaged instead. The measured texels are drawn with a fixed seed.
std::vector<LevelCheck> checkLevels(const MaterialMap& map, ParameterMaps& maps,
                                    const ModelLobes& lobes, const TexelKernel& kernel,
                                    std::size_t checks, const Listener& listener);

}  // namespace hshfit::jobs
