#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Rough diffuse surface of V-shaped Lambertian grooves. Oren & Nayar 1994, 10.1145/192161.192213.
/// sigma: standard deviation of the groove angle; s = sigma^2 in radians^2; alpha, beta: the larger
/// and the smaller polar angle; D: difference of the azimuths.
///     simplified  f = kd/pi (A + B max(0, cos D) sin alpha tan beta)
///                 A = 1 - s/2 / (s + 0.33),  B = 0.45 s / (s + 0.09)             (their Eq. 30)
///     full        f = kd/pi (C1 + cos D C2 tan beta + (1 - |cos D|) C3 tan((alpha + beta)/2))
///                   + 0.17 kd^2/pi s/(s + 0.13) (1 - cos D (2 beta/pi)^2)        (their Eq. 29)
///                 C1 = A,  C2 = B (sin alpha - [cos D < 0] (2 beta/pi)^3),
///                 C3 = 0.125 s/(s + 0.09) (4 alpha beta/pi^2)^2
/// Both grow without bound where both directions graze on the same side. The full form turns
/// negative for large sigma where both graze on opposite sides; it is cut to 0 there.
const Model& orenNayarModel();

}  // namespace hshfit::brdfs
