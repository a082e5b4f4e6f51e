#pragma once

#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/light/light_nodes.h>
#include <hshfit/light/lights.h>

#include <span>
#include <vector>

namespace hshfit::inline light {

struct LightProjectionOptions {
    LightDomain domain = {};
    double tolerance = 1e-9;  ///< of the coefficients, relative, where they come from quadrature
    int maxLevel = 4;         ///< of quadrature; each has 2.25 times the nodes of the one before
};

/// Coefficients of incident radiance, the sum of `lights`, in a basis:
///     c_{l,m} = integral over the domain of L B_{l,m} d omega,   linear Rec. 709,
/// with energy and the captured energy of every order.
/// Whole sphere (SH only, else UsageError): exact but for rounding, to order 1000, for
/// latitude-longitude pictures (latlong_projection.h), light from one direction, and discs, whose
/// zonal coefficients are 2 pi times the integral of P_l from cos r to 1, sin r P_l^1(cos r) /
/// (l (l + 1)), turned by the addition theorem. All else, and every light of a hemisphere: nodes
/// (light_nodes.h) at levels until two agree; the last difference of the coefficients is the stated
/// error. lsosh solves a Gram system, which enlarges the errors of the integrals.
/// Throws UsageError without lights.
LightCoefficients projectLight(std::span<const Light> lights, const Basis& basis,
                               const LightProjectionOptions& options = {});

/// Energy of each band of orthonormal coefficients: sum over m and channels of c^2.
std::vector<double> bandEnergies(const LightCoefficients& light);

}  // namespace hshfit::inline light
