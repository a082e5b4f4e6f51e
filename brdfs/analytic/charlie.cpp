#include <brdfs/analytic/charlie.h>

#include <brdfs/analytic/charlie_shape.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/sampling/axis_lobes.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct CharlieShape {
    CharlieCurve<N> curve;
    bool soft;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/charlie_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalCharlie);
HWY_EXPORT(charlieColumns);

constexpr Laws claims{.nonNegative = true, .isotropic = true, .mirrorSymmetric = true};

bool isSoft(const Parameters& p) {
    return p.choice("terminator") == "soft";
}

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.reciprocal = !isSoft(p);
    return result;
}

void evalByVectors(const CharlieShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalCharlie)(shape, batch);
}

class Charlie final : public ShapedBrdf<CharlieShape<double>, evalByVectors,
                                        evalAll<double, CharlieTerms, CharlieShape<double>>> {
public:
    explicit Charlie(const Parameters& p)
        : ShapedBrdf(charlieModel(), p, lawsOf(p), channelWeights<CharlieFormula>(p),
                     CharlieFormula::shape(Values<double>(p, 0))) {}

    /// sin^(1/r) is singular at the normal and nearly constant beyond a slope of 1.
    std::vector<Lobe> lobes(const Direction&) const override {
        return {{Lobe::About::halfway, 0.5, {}}};
    }

    /// The authors' fit of Lambda has a kink at 60 degrees and is itself
    /// approximate.
    std::vector<double> kinks(const Direction&) const override { return {0.5}; }
    double defaultTolerance() const override { return 1e-5; }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Charlie>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(charlieColumns)(request);
}

/// The uniform hemisphere: the sheen is broad, and bright near the horizon.
HasSamplers::Known sampling(const Parameters&) {
    return {.all = true, .samplers = {powerCosineSampler(normalAxis, 0)}};
}

}  // namespace

const Model& charlieModel() {
    static const Model model{
        .name = "charlie",
        .help = "sheen of cloth: facets that stand up, bright towards grazing angles",
        .source = "Estevez & Kulla 2017, Production friendly microfacet sheen BRDF",
        .parameters = {ksParameter("sheen colour", 1),
                       {.name = "r",
                        .help = "roughness of the fibres",
                        .min = 0.01,
                        .max = 1,
                        .fit = {{.low = 0.05, .high = 0.95}}},
                       {.name = "terminator",
                        .help = "masking as fitted, or softened for the light (not reciprocal)",
                        .kind = Parameter::Kind::choice,
                        .choices = {"fitted", "soft"}}},
        .laws = claims,
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
