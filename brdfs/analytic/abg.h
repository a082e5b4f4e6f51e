#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// f = kd / pi + A / (B + |D|^g), D = the projection of wi + wo on the surface: the deviation
/// |beta - beta_0| of wi from the mirror direction of wo in direction cosines. The ABg model of
/// optical design programs for scatter from polished surfaces: Breault Research, ASAP reference
/// guide; Pfisterer, "Approximated scatter models for stray light analysis", Optics & Photonics
/// News 22 (10), 2011, 16-17. The height at the mirror direction is A / B, the lobe is as wide as
/// B^(1/g), and A / |D|^g is its tail. At normal incidence and g = 2 the lobe reflects
/// pi A ln(1 + 1/B) (total integrated scatter). The tail does not fall off at grazing angles.
const Model& abgModel();

}  // namespace hshfit::brdfs
