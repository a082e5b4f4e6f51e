#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/light/views.h>
#include <hshfit/representation/pair_evaluator.h>
#include <hshfit/representation/representation.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::inline light {

/// L(wo) = sum over k of flux[k] f(wi_k, wo) cos(theta_k) for every view, f grey or RGB.
/// Runs on all threads; the sum does not depend on their number.
Radiance outgoingRadiance(const Brdf& brdf, const LightSamples& light, const Views& views);

/// The same from `pairEvaluator`, in single precision and much faster for the halfway form.
Radiance outgoingRadiance(const PairEvaluator& evaluator, std::size_t channels,
                          const LightSamples& light, const Views& views);

/// Lighting in one basis, which turns coefficients over wi into outgoing radiance without a sum
/// over light samples. The same sum as `outgoingRadiance` in another order:
///     L(wo) = sum over l, m of c_{l,m}(wo) E_{l,m},   E = sum over k of flux[k] w_k B_{l,m}(wi_k)
/// with w = cos(theta_k) for coefficients of f, 1 for coefficients of f cos(theta_i).
class BasisLight {
public:
    BasisLight(const Basis& basis, Quantity quantity, const LightSamples& light);
    /// `values`: E, [R, G, B][slot].
    BasisLight(int order, std::vector<double> values) : order_(order), values_(std::move(values)) {}

    /// `coefficients`: [channel][slot] at `order` bands, one channel or three; `turn` as in
    /// OutgoingLookup.
    Rgb radiance(std::span<const double> coefficients, int order, double turn) const;

    /// [l]: power of a band, sum over m and R, G, B of E^2.
    std::vector<double> bandPower() const;

    /// E, [R, G, B][slot].
    std::span<const double> values() const { return values_; }

private:
    int order_;
    std::vector<double> values_;
};

/// Radiance from a representation's coefficients under light in its basis, without `added`. Not for
/// the halfway form, which is not linear.
Radiance linearRadiance(const Representation& representation, const BasisLight& light,
                        const Views& views);

}  // namespace hshfit::inline light
