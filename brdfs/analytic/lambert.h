#pragma once

#include <brdfs/catalog.h>

namespace hshfit::brdfs {

/// f = kd / pi. Lambert, "Photometria", 1760. kd is the albedo.
const Model& lambertModel();

}  // namespace hshfit::brdfs
