#include <brdfs/analytic/beckmann.h>

#include <brdfs/analytic/facet_normals.h>
#include <brdfs/analytic/microfacet.h>
#include <hshfit/sampling/visible_normals.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hshfit::brdfs {

template <class N>
struct BeckmannShape {
    RoughnessOf<N> r;

    /// exp(-(t / alpha)^2) has a standard deviation of alpha / sqrt(2).
    N widthX() const { return 2.5 / std::numbers::sqrt2 * r.ax; }
    N widthY() const { return 2.5 / std::numbers::sqrt2 * r.ay; }
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/beckmann_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalBeckmann);
HWY_EXPORT(beckmannColumns);

class Beckmann : public Microfacet<BeckmannShape<double>> {
public:
    using Microfacet::Microfacet;

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalBeckmann)(shape(), batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::BeckmannTerms>(shape(), batch);
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    const Roughness roughness = roughnessOf(beckmannModel(), p);
    return std::make_unique<WithFacetNormals<Beckmann>>(
        microfacetNormals(beckmannModel(), p, beckmannNormals(roughness.ax, roughness.ay),
                          roughness, true),
        beckmannModel(), p, microfacetLaws(p, roughness), BeckmannShape<double>{roughness});
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(beckmannColumns)(request);
}

/// Exact up to Fresnel's factor and the masking of wi.
HasSamplers::Known sampling(const Parameters& p) {
    const Roughness r = roughnessOf(beckmannModel(), p);
    return {.all = true, .samplers = {beckmannSampler(r.ax, r.ay)}};
}

}  // namespace

const Model& beckmannModel() {
    static const Model model{
        .name = "beckmann",
        .help = "microfacets of Gaussian slope with Smith masking",
        .source =
            "Walter, Marschner, Li & Torrance 2007, 10.2312/EGWR/EGSR07/195-206; "
            "Heitz 2014, JCGT 3(2)",
        .parameters = microfacetParameters(),
        .laws = microfacetClaims,
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
