#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/projection/projection.h>
#include <hshfit/representation/halfway/halfway_envelope.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/representation/pair_evaluator.h>
#include <hshfit/representation/representation.h>

#include <cstddef>
#include <memory>

namespace hshfit::inline representation::inline halfway {

/// The halfway form in double precision, without `added`, with E of halfway_envelope.h:
///     f = min(E, max(0, exp(sum over t of c_t P_t) - 1)).
/// Immutable; safe to use from many threads.
class HalfwayExpansion {
public:
    /// Throws InputError if the arrays, the orders and the channels do not agree.
    explicit HalfwayExpansion(const Representation& representation);

    const HalfwayTerms& terms() const { return terms_; }
    const HalfwayEnvelope& envelope() const { return envelope_; }

    /// Laid out as for `Brdf::eval`: out[channel * wi.count + k], 1/sr, 0 below the horizon.
    void evaluate(const Direction& wo, DirectionBatch wi, double* out) const;

private:
    HalfwayTerms terms_;
    std::size_t channels_;
    std::vector<double> values_;  ///< [term][channel]
    HalfwayEnvelope envelope_;
};

/// More terms a channel than that take too long to fit: time goes with the square of their number.
inline constexpr std::size_t mostHalfwayTerms = 1500;

/// For `pairEvaluator`, without `added`. Throws InputError as HalfwayExpansion does.
std::unique_ptr<PairEvaluator> halfwayPairEvaluator(const Representation& representation);

/// Fits the expansion to `brdf`: the least mean of |ln(1 + f c) - ln(1 + g c)|, c = cos(theta_i),
/// by reweighted least squares, over pairs uniform on both hemispheres (weight 0.96), spread over
/// the axes (0.02) and towards the horizon (0.02), then with directional albedos
/// (halfway_albedo.h). Nowhere is f above 1.5 times the greatest of `brdf` at the same elevations
/// (the greater of both orders where reciprocal), or a thousandth of albedo / pi (`boundsOf`). f <
/// 0 counts as 0. The number of pairs doubles until the error over pairs that took no part changes
/// by less than 2 %; `head.error` and the last step are that error. Results do not depend on
/// threads. Terms keep the symmetries of `brdf.laws()`; `reciprocal` asks for those only that are
/// symmetric in wi and wo, and for an isotropic BRDF mirror symmetric. Of `options` only `progress`
/// (pairs done and in all) and `maxEvaluations` (of f by pairs) are used. Throws NumericError where
/// f is not finite, UsageError for more than mostHalfwayTerms a channel.
Representation projectHalfway(const Brdf& brdf, const HalfwayOrders& orders,
                              const ProjectionOptions& options = {}, bool reciprocal = false);

/// The orders whose form, stored in `precision`, takes at most `bytes` and has the least error over
/// pairs that take no part in the fit, of all with 4 to 16, 2 to 8 and 1 to 7 functions. They are
/// ranked by the residual of one weighted least-squares system; the best four are then fitted and
/// quantised. Throws UsageError if not even the smallest fits, and as projectHalfway does.
HalfwayOrders chooseHalfwayOrders(const Brdf& brdf, std::size_t bytes, Precision precision,
                                  const ProjectionOptions& options = {}, bool reciprocal = false);

/// Mean of |ln(1 + f c) - ln(1 + g c)| over pairs uniform on both hemispheres and over channels;
/// the pairs are not among those that projectHalfway fits.
double halfwayError(const Brdf& brdf, const Representation& representation);

}  // namespace hshfit::inline representation::inline halfway
