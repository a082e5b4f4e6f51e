#pragma once

#include <hshfit/brdf.h>
#include <hshfit/projection.h>
#include <hshfit/representation/pair_evaluator.h>
#include <hshfit/representation/representation.h>

#include <memory>

namespace hshfit {

/// One product function of the halfway form: with (theta_h, theta_d, phi_d) Rusinkiewicz' angles,
///     P = p_i(u) p_j(v) sin(theta_d)^(2k) cos(2 k phi_d),
/// p orthonormal Legendre on [-1, 1], u = 2 sqrt(2 theta_h / pi) - 1, v = 4 theta_d / pi - 1.
struct HalfwayTerm {
    int i = 0, j = 0, k = 0;
};

/// f of the expansion for one wo, laid out as for `Brdf::eval`, without `added`. Called by
/// `reconstruct`; throws InputError (from a check made once) if array and orders do not agree.
void evaluateHalfway(const Representation& representation, const Direction& wo, DirectionBatch wi,
                     double* out);

/// For `pairEvaluator`, without `added`.
std::unique_ptr<PairEvaluator> halfwayPairEvaluator(const Representation& representation);

/// Fits the expansion to `brdf`.
Representation projectHalfway(const Brdf& brdf, const HalfwayOrders& orders,
                              const ProjectionOptions& options = {});

}  // namespace hshfit
