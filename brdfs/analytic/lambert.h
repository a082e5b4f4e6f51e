#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd / pi. Lambert, "Photometria", 1760. kd is the albedo.
const Model& lambertModel();

/// f_t = kt / pi over the two opposite hemispheres: an ideal diffuser (hshfit/brdf/transmission.h).
/// kt is the transmittance.
const Model& lambertTransmissionModel();

}  // namespace hshfit::brdfs
