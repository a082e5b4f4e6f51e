#include <brdfs/analytic/gtr.h>

#include <brdfs/analytic/microfacet.h>
#include <brdfs/analytic/parameters.h>
#include <hshfit/sampling/visible_normals.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace hshfit::brdfs {

/// The ratio of Lambda to GGX's. Its logarithm is tabulated over the logarithm of the
/// cotangent, where it is smooth; it is constant beyond both ends.
template <class N>
struct LambdaTable {
    static constexpr double step = 0.04, high = 12;
    N low;
    std::vector<N> values;  ///< at low + k step
};

template <class N>
struct GtrShape {
    N alpha, gamma, peak;
    std::shared_ptr<const LambdaTable<N>> table;

    N widthX() const { return std::min(1.0, alpha); }
    N widthY() const { return widthX(); }
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/gtr_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalGtr);
HWY_EXPORT(gtrColumns);

class Gtr final : public Microfacet<GtrShape<double>> {
public:
    using Microfacet::Microfacet;

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalGtr)(shape(), batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        evalAll<double, GtrTerms>(shape(), batch);
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    Laws laws = microfacetLaws(p, {1, 1});
    return std::make_unique<Gtr>(gtrModel(), p, laws,
                                 GtrFormula::distribution(Values<double>(p, 0)));
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(gtrColumns)(request);
}

std::vector<Parameter> parameters() {
    std::vector<Parameter> all{kdParameter(0, 1), facetScaleParameter()};
    for (const Parameter& parameter : facetFresnelParameters()) all.push_back(parameter);
    all.push_back({.name = "alpha",
                   .help = "roughness",
                   .min = 1e-4,
                   .max = 1,
                   .fit = {{.low = 3e-3, .high = 0.7, .logarithmic = true}}});
    all.push_back({.name = "gamma",
                   .help = "fall of the tails; 2 is GGX, less has longer ones",
                   .min = 0.1,
                   .max = 10,
                   .fit = {{.low = 1, .high = 4, .logarithmic = true}}});
    all.push_back(maskingParameter());
    return all;
}

/// Samples normals by the D of the model as they are visible: under the masking of GGX for gamma =
/// 2, under the masking of V-shaped grooves for other gammas.
HasSamplers::Known sampling(const Parameters& p) {
    const double alpha = p.number("alpha"), gamma = p.number("gamma");
    if (gamma == 2) return {.all = true, .samplers = {ggxSampler(alpha, alpha)}};
    return {.all = true, .samplers = {grooveSampler(gtrNormals(alpha, gamma))}};
}

}  // namespace

const Model& gtrModel() {
    static const Model model{
        .name = "gtr",
        .help = "generalised Trowbridge-Reitz microfacets with their own Smith masking",
        .source =
            "Burley 2012, Physically-based shading at Disney, SIGGRAPH course notes; "
            "Heitz 2014, JCGT 3(2)",
        .parameters = parameters(),
        .laws = {.nonNegative = true,
                 .reciprocal = true,
                 .isotropic = true,
                 .mirrorSymmetric = true},
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
