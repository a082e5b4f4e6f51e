#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd (k + 1)/(2 pi) (cos_i cos_o)^(k - 1). Minnaert, "The reciprocity principle in lunar
/// photometry", Astrophys. J. 93, 1941, 10.1086/144279: the dependence on both angles only; his
/// constant is chosen here so that the albedo is kd cos_o^(k - 1), kd at normal incidence.
/// k = 1 is Lambert. k < 1 brightens the limb (the Moon is near 0.5) and is unbounded there: the
/// albedo exceeds 1 towards grazing, and for k <= 1/2 the integral of f^2 does not exist.
const Model& minnaertModel();

}  // namespace hshfit::brdfs
