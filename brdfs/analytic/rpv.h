#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Land surfaces: Rahman, Pinty & Verstraete 1993, "Coupled surface-atmosphere reflectance (CSAR)
/// model, 2", 10.1029/93JD02072. With the phase angle g between wi and wo,
///     f = rho0 / pi (cos_i cos_o (cos_i + cos_o))^(k - 1) F(g) (1 + (1 - rhoc) / (1 + G))
///     F(g) = (1 - Theta^2) / (1 + 2 Theta cos g + Theta^2)^(3/2)
///     G^2 = tan_i^2 + tan_o^2 - 2 tan_i tan_o cos phi
/// k < 1 is a bowl (brighter limb), k > 1 a bell; Theta < 0 scatters back, > 0 forward. `rhoc` is
/// the hot spot's, equal to rho0 unless it is stated; 1 is none. For k < 1 f is unbounded at the
/// horizon.
const Model& rpvModel();

}  // namespace hshfit::brdfs
