#pragma once

#include <hshfit/brdf.h>
#include <hshfit/projection.h>
#include <hshfit/representation/representation.h>

namespace hshfit {

/// One product function of the halfway form: with (theta_h, theta_d, phi_d) Rusinkiewicz' angles,
///     P = p_i(u) p_j(v) sin(theta_d)^(2k) cos(2 k phi_d),
/// p orthonormal Legendre on [-1, 1], u = 2 sqrt(2 theta_h / pi) - 1, v = 4 theta_d / pi - 1.
struct HalfwayTerm {
    int i = 0, j = 0, k = 0;
};

}  // namespace hshfit
