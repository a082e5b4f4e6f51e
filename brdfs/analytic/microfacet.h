#pragma once

#include <brdfs/analytic/facet_fresnel.h>
#include <brdfs/analytic/ggx_shape.h>
#include <brdfs/analytic/kink_curves.h>
#include <brdfs/analytic/term_brdf.h>

#include <vector>

namespace hshfit::brdfs {

using Roughness = RoughnessOf<double>;

/// The parameters that all microfacet models have: kd, ks, F0 | ior, k (facet_fresnel.h), alpha
/// | ax, ay, and masking.
std::vector<Parameter> microfacetParameters();
Parameter facetScaleParameter();
Parameter maskingParameter();
/// Throws UsageError unless either alpha or both ax and ay are given.
Roughness roughnessOf(const Model& model, const Parameters& parameters);
Laws microfacetLaws(const Parameters& parameters, const Roughness& roughness);
inline constexpr Laws microfacetClaims{
    .nonNegative = true, .reciprocal = true, .mirrorSymmetric = true};

/// The inputs of the terms of a microfacet model (facet_terms.h), in numbers N.
template <class Shape, class N = double>
struct FacetShape {
    Shape distribution;
    std::vector<FacetIndex<N>> indices;  ///< empty for Schlick's form
    bool correlated;
};

/// f = kd / pi + ks F D G / (4 cos_i cos_o), with F of the angle between wo and h (facet_fresnel.h)
/// and Smith's masking in terms of Lambda (Heitz 2014, JCGT 3(2)):
///     correlated  G = 1 / (1 + Lambda_i + Lambda_o)   (heights of both directions correlated)
///     separable   G = 1 / ((1 + Lambda_i)(1 + Lambda_o))
///
/// `Shape` holds the parameters of D and gives the width of its peak along x and along y, in
/// units of slope.
template <class Shape>
class Microfacet : public TermBrdf, public HasKinkCurves {
public:
    Microfacet(const Model& model, const Parameters& p, const Laws& laws, const Shape& distribution)
        : Microfacet(model, p, laws, FacetFresnel(model, p), distribution) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        return {halfwayLobe(shape_.distribution.widthX(), shape_.distribution.widthY())};
    }

    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        std::vector<KinkCurve> curves;
        for (const FacetIndex<double>& index : shape_.indices) {
            if (index.k > 0) continue;
            for (const KinkCurve& curve : totalReflectionKinks(wo, {&index.ior, 1}))
                curves.push_back(curve);
        }
        return curves;
    }

protected:
    const FacetShape<Shape>& shape() const { return shape_; }

private:
    Microfacet(const Model& model, const Parameters& p, const Laws& laws,
               const FacetFresnel& fresnel, const Shape& distribution)
        : TermBrdf(model, p, laws, overPi(p.colour("kd")), fresnel.weights(p.colour("ks"))),
          shape_{distribution, fresnel.indices(), p.choice("masking") == "correlated"} {}

    FacetShape<Shape> shape_;
};

}  // namespace hshfit::brdfs
