#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/projection/projection.h>
#include <hshfit/representation/halfway/halfway_axes.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/representation/pair_evaluator.h>
#include <hshfit/representation/representation.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit::inline representation::inline halfway {

template <class T>
struct HalfwayLayout;

/// The halfway form in double precision, without `added`: a smooth part and a lobe, each positive,
///     f = min(exp(min(A, a)) + L exp(min(B, b)), t),
/// where A and B are sums of coefficients times terms, the smooth terms for A and the terms of the
/// lobe for B (halfway_terms.h), L is the lobe of halfway_axes.h, and a, b, t are the ceilings of
/// the channel. Immutable; safe to use from many threads.
class HalfwayExpansion {
public:
    /// Throws InputError if the arrays, the orders, the lobe and the channels do not agree.
    explicit HalfwayExpansion(const Representation& representation);

    const HalfwayTerms& terms() const { return terms_; }
    const HalfwayAxes& axes() const { return axes_; }
    const std::vector<HalfwayCeiling>& ceilings() const { return ceilings_; }
    std::size_t channels() const { return channels_; }
    double value(std::size_t term, std::size_t channel) const {
        return values_[term * channels_ + channel];
    }

    /// Laid out as for `Brdf::eval`: out[channel * wi.count + k], 1/sr, 0 below the horizon.
    void evaluate(const Direction& wo, DirectionBatch wi, double* out) const;

private:
    HalfwayTerms terms_;
    HalfwayAxes axes_;
    std::size_t channels_;
    std::vector<double> values_;  ///< [term][channel]
    std::vector<HalfwayCeiling> ceilings_;
    std::shared_ptr<const HalfwayLayout<double>> layout_;  ///< the same, for vector code
};

/// More terms a channel than that take too long to fit: time goes with the square of their number.
inline constexpr std::size_t mostHalfwayTerms = 1500;

/// For `pairEvaluator`, without `added`. Throws InputError as HalfwayExpansion does.
std::unique_ptr<PairEvaluator> halfwayPairEvaluator(const Representation& representation);

/// Fits the form to `brdf`: the least mean of Huber's function of ln(g + e) - ln(f + e), where e is
/// a thousandth of the greatest mean albedo, over pairs spread over the hemispheres, about the
/// mirror direction, on its ridge, on lines through the highlight, towards the horizon and at
/// normal incidence (halfway_samples.h), with the directional albedos as residuals of their own
/// (halfway_albedo.h), by Levenberg and Marquardt's method. The lobe's width is the best of a set.
/// f < 0 counts as 0. The ceilings are the greatest exponents, and the greatest f, over the pairs.
/// `head.error` and the last step are the error over pairs that took no part, as halfwayError has
/// it. Results do not depend on threads. Terms keep the symmetries of `brdf.laws()`; `reciprocal`
/// asks for the terms only that are symmetric in wi and wo, and for an isotropic BRDF mirror
/// symmetric. `options` are `progress` (steps done and in all) and `maxEvaluations` (of f by
/// pairs); the others are not used. Throws NumericError where f is not finite, UsageError for more
/// than mostHalfwayTerms a channel.
Representation projectHalfway(const Brdf& brdf, const HalfwayOrders& orders,
                              const ProjectionOptions& options = {}, bool reciprocal = false);

/// The orders whose form, stored in `precision`, takes at most `bytes` and has the least loss of
/// projectHalfway over pairs that take no part in the fit, of a ladder of orders. Throws UsageError
/// if not even the smallest fits, and as projectHalfway does.
HalfwayOrders chooseHalfwayOrders(const Brdf& brdf, std::size_t bytes, Precision precision,
                                  const ProjectionOptions& options = {}, bool reciprocal = false);

/// Mean of |ln(1 + f c) - ln(1 + g c)|, c = cos(theta_i), over pairs uniform on both hemispheres
/// and over channels; projectHalfway does not fit any of these pairs.
double halfwayError(const Brdf& brdf, const Representation& representation);

}  // namespace hshfit::inline representation::inline halfway
