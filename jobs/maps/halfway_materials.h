#pragma once

#include <jobs/common/listener.h>
#include "texel_brdfs.h"

#include <hshfit/material_maps/material_map.h>
#include <hshfit/material_maps/processes.h>
#include <hshfit/representation/representation.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The shared materials of a map in the halfway form. The form is not linear in reflectance, so
/// that no mean of two is one: each is the fit (projectHalfway, in half precision) to the BRDF of
/// the texel whose stated distance to the centre is the least, of a level above 0 to the mean BRDF
/// of up to 16 texels below it. [material]
struct HalfwayMaterials {
    std::vector<std::string> texts = {};  ///< coefficient files; empty where no texel has the index
    std::vector<Representation> forms = {};

    std::size_t bytes(std::size_t first, std::size_t last) const;  ///< of materials [first, last)
};

/// The materials of a written map, whose indices say which texels a material has. Shared out among
/// processes; each has all. Throws InputError, and NumericError as projectHalfway does.
HalfwayMaterials halfwayMaterials(const MaterialMap& map, ParameterMaps& maps,
                                  const HalfwayOrders& orders, Processes& processes,
                                  const Listener& listener);

}  // namespace hshfit::jobs
