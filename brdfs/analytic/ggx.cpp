#include <brdfs/analytic/ggx.h>

#include <brdfs/analytic/facet_normals.h>
#include <brdfs/analytic/ggx_shape.h>
#include <brdfs/analytic/microfacet.h>
#include <hshfit/sampling/visible_normals.h>

#include <algorithm>
#include <cmath>

#define HWY_TARGET_INCLUDE "brdfs/analytic/ggx_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalGgx);
HWY_EXPORT(ggxColumns);

class Ggx : public Microfacet<GgxShape<double>> {
public:
    using Microfacet::Microfacet;

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalGgx)(shape(), batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::GgxTerms>(shape(), batch);
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    const Roughness roughness = roughnessOf(ggxModel(), p);
    return std::make_unique<WithFacetNormals<Ggx>>(
        microfacetNormals(ggxModel(), p, ggxNormals(roughness.ax, roughness.ay), roughness, false),
        ggxModel(), p, microfacetLaws(p, roughness), GgxShape<double>{roughness});
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(ggxColumns)(request);
}

/// Exact up to Fresnel's factor and the masking of wi.
HasSamplers::Known sampling(const Parameters& p) {
    const Roughness r = roughnessOf(ggxModel(), p);
    return {.all = true, .samplers = {ggxSampler(r.ax, r.ay)}};
}

}  // namespace

const Model& ggxModel() {
    static const Model model{
        .name = "ggx",
        .help = "GGX (Trowbridge-Reitz) microfacets with Smith masking",
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
