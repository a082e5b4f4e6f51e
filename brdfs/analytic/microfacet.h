#pragma once

#include <brdfs/analytic/facet_fresnel.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_brdf.h>

namespace hshfit::brdfs {

/// Roughness along the two axes: both equal to `alpha`, or `ax` and `ay`.
struct Roughness {
    double ax, ay;
};

/// kd, ks, F0 | ior, k (facet_fresnel.h), alpha | ax, ay, and masking: what the microfacet models
/// have in common.
std::vector<Parameter> microfacetParameters();
Parameter facetScaleParameter();
Parameter maskingParameter();
/// Throws UsageError unless either alpha or both ax and ay are given.
Roughness roughnessOf(const Model& model, const Parameters& parameters);
Laws microfacetLaws(const Parameters& parameters, const Roughness& roughness);
inline constexpr Laws microfacetClaims{
    .nonNegative = true, .reciprocal = true, .mirrorSymmetric = true};

/// f = kd / pi + ks F D G / (4 cos_i cos_o), with F of the angle between wo and h (facet_fresnel.h)
/// and Smith's masking in terms of Lambda (Heitz 2014, JCGT 3(2)):
///     correlated  G = 1 / (1 + Lambda_i + Lambda_o)   (heights of both directions correlated)
///     separable   G = 1 / ((1 + Lambda_i)(1 + Lambda_o))
///
/// `Distribution` gives D of a half vector, z Lambda(w) of a direction w with height z (finite at
/// the horizon, where Lambda is not), and the width of its peak in units of slope.
template <class Distribution>
class Microfacet final : public TermBrdf {
public:
    Microfacet(const Model& model, const Parameters& p, const Laws& laws,
               const Distribution& distribution)
        : Microfacet(model, p, laws, distribution, FacetFresnel(model, p)) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        return {{Lobe::About::halfway, distribution_.width(), {}, distribution_.spread()}};
    }

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        const double outgoing = distribution_.scaledLambda(wo.x, wo.y, wo.z);
        for (std::size_t k = 0; k < wi.count; ++k) {
            const double z = std::max(wi.z[k], 0.0);
            const HalfVector h(wo, wi.x[k], wi.y[k], z);
            const double incoming = distribution_.scaledLambda(wi.x[k], wi.y[k], z);
            const double visible = correlated_ ? z * wo.z + wo.z * incoming + z * outgoing
                                               : (z + incoming) * (wo.z + outgoing);
            const double lobe = bounded(distribution_.density(h) * bounded(0.25 / visible));
            fresnel_.spread(lobe, h.dotOutgoing(), out + k, wi.count);
        }
    }

private:
    Microfacet(const Model& model, const Parameters& p, const Laws& laws,
               const Distribution& distribution, const FacetFresnel& fresnel)
        : TermBrdf(model, p, laws, overPi(p.colour("kd")), fresnel.weights(p.colour("ks"))),
          distribution_(distribution),
          fresnel_(fresnel),
          correlated_(p.choice("masking") == "correlated") {}

    Distribution distribution_;
    FacetFresnel fresnel_;
    bool correlated_;
};

}  // namespace hshfit::brdfs
