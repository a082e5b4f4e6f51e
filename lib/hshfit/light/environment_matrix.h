#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/coefficients/coefficients.h>

#include <vector>

namespace hshfit::inline light {

/// One element that is not 0 of the environment matrix
///     M_{kj} = integral over the hemisphere of B_k Y_j c d omega,
/// c = cos(theta) where f was projected and 1 where f cos(theta_i) was, B_k the functions of a
/// basis and Y_j the spherical harmonics, orthonormal over the sphere, both with the same
/// Condon-Shortley sign.
struct EnvironmentElement {
    int slot = 0;         ///< of B_k
    int environment = 0;  ///< slot of Y_j
    double value = 0;
};

/// Ordered by slot, then by environment slot. M is block diagonal in m, and the blocks of m and -m
/// are equal. By BasisChange: exact to rounding. Elements below 1e-9 in magnitude count as 0.
std::vector<EnvironmentElement> environmentMatrix(const Basis& basis, int environmentOrder,
                                                  Quantity quantity);

}  // namespace hshfit::inline light
