#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>

#include <vector>

namespace hshfit::inline representation::inline constraints {

/// The polar angle of the lowest outgoing directions that are kept.
inline constexpr double lowestRing = 89 * (pi / 180);

/// In slots: what each function of the basis contributes to the directional albedo,
///     integral of B cos(theta_i) d omega_i, or of B d omega_i for coefficients of f cos(theta_i);
/// by Gauss-Legendre nodes in sqrt(cos theta), exact. Only m = 0 is not 0.
std::vector<double> albedoMoments(const Basis& basis, Quantity quantity);

/// [direction][channel]: the directional albedo of `source`, to the larger of 1e-6 and a tenth of
/// its tolerance; at most 1 where it is reciprocal and conserves energy. Directions that its
/// symmetries make alike are evaluated once.
std::vector<double> albedoBounds(const Brdf& source, const std::vector<Direction>& directions);

/// Upper limits of the albedos of one channel at the stored directions, under which albedos that
/// are interpolated between them stay below their bounds as well: the targets a' <= a with the
/// least sum of solid angle times (a - a')^2, by Hildreth's method (1957). Ends when no bound is
/// exceeded by more than 1e-10, or after `mostSweeps`: then throws NumericError for an excess above
/// 1e-6, which is what the bounds themselves are known to (`albedoBounds`).
struct InterpolatedBound {
    OutgoingLookup lookup;  ///< stored directions and their weights
    double most = 0;
};
std::vector<double> albedoTargets(const std::vector<double>& albedos,
                                  const std::vector<double>& solidAngles,
                                  const std::vector<InterpolatedBound>& bounds,
                                  int mostSweeps = 5000);

/// The stored directions, the points halfway between neighbours of the map, and the horizon ring.
std::vector<Direction> albedoChecks(const OutgoingSet& set);

}  // namespace hshfit::inline representation::inline constraints
