#pragma once

#include "model_lobes.h"
#include "svbrdf.h"

#include <hshfit/material_maps/material_map.h>

namespace hshfit::jobs {

/// Texels to check of each level, and the processes that share them.
struct CheckWork {
    std::size_t checks = 16;
    Processes& processes;
};

/// Texels of every level of a written map against the texels that they stand for, and the same for
/// texels whose parameters are averaged instead. The measured texels are drawn with a fixed seed.
std::vector<LevelCheck> checkLevels(const MaterialMap& map, ParameterMaps& maps,
                                    const ModelLobes& lobes, const TexelKernel& kernel,
                                    const CheckWork& work, const Listener& listener);

}  // namespace hshfit::jobs
