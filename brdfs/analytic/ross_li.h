#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = max(0, iso + vol K_vol + geo K_geo) / pi, the reflectance of land surfaces as MODIS has it:
/// RossThick and LiSparse-Reciprocal kernels. Wanner, Li & Strahler 1995, 10.1029/95JD02371; Lucht,
/// Schaaf & Strahler 2000, 10.1109/36.841980. With the phase angle xi between wi and wo,
///     K_vol = ((pi/2 - xi) cos xi + sin xi) / (cos_i + cos_o) - pi/4
///     K_geo = O - sec_i - sec_o + (1 + cos xi') sec_i sec_o / 2
///     O = (t - sin t cos t) (sec_i + sec_o) / pi
///     cos t = hb sqrt(D^2 + (tan_i tan_o sin phi)^2) / (sec_i + sec_o), at most 1
///     D^2 = tan_i^2 + tan_o^2 - 2 tan_i tan_o cos phi
/// where K_geo has polar angles with tan' = br tan. `hb` = h/b = 2 and `br` = b/r = 1 are the
/// shape of MODIS's crowns. The kernels are negative for many pairs; f is cut at 0. Past 75 degrees
/// the kernels were not meant to be used.
const Model& rossLiModel();

}  // namespace hshfit::brdfs
