#pragma once

#include <hshfit/projection/projection.h>

#include <cmath>
#include <optional>
#include <utility>

namespace hshfit::inline projection {

/// Projects `brdf` over wi onto one basis, for every outgoing direction:
///     c_{l,m}(wo) = integral of q(wi, wo) B_{l,m}(wi) d omega_i,    q = f or f cos(theta_i),
/// the same numbers as `project` onto several bases gives for it, with the same errors.
inline Projection project(const Brdf& brdf, const Basis& basis, const OutgoingSet& outgoing,
                          const ProjectionOptions& options = {}) {
    const Basis* const one[] = {&basis};
    return std::move(project(brdf, one, outgoing, options).front());
}

/// The accuracy of a projection (Gautron et al. 2004, Eq. 15): the share of the energy of q that
/// the basis captures, without unit,
///     sum over wo of the energy of sum_{l,m} c_{l,m}(wo) B_{l,m} / sum over wo of the energy of q,
/// energies in the inner product of the basis, over all channels, times the solid angles of wo.
/// 1 - accuracy is the square of the relative error in that norm. At most 1, but for the error
/// of the quadrature (Coefficients::error).
///
/// None where the energy of q does not exist (the square of f may have no integral) or is 0, and
/// for least-squares coefficients, which have no energy.
inline std::optional<double> capturedShare(const Projection& projection) {
    const CoefficientHead& head = projection.coefficients;
    const Energy& energy = head.energy;
    const bool known = energy.finite && std::isfinite(energy.value) && energy.value > 0;
    if (head.leastSquares || !known || projection.captured.empty()) return std::nullopt;
    return projection.captured.back() / energy.value;
}

}  // namespace hshfit::inline projection
