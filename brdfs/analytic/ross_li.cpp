#include <brdfs/analytic/ross_li.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

namespace hshfit::brdfs {

struct RossLiShape {
    double hb, br;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/ross_li_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalRossLi);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = largest(p.colour("vol")) == 0 && largest(p.colour("geo")) == 0 &&
                              largest(p.colour("iso")) <= 1;
    return result;
}

void evalByVectors(const RossLiShape& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalRossLi)(shape, batch);
}

/// The hot spot, where wi nears wo, is a cusp of K_geo. Without columns: f is cut at 0, so that it
/// is not linear in its weights, and fits take differences.
class RossLi final
    : public ShapedBrdf<RossLiShape, evalByVectors, evalAll<double, RossLiTerms, RossLiShape>> {
public:
    explicit RossLi(const Parameters& p)
        : ShapedBrdf(rossLiModel(), p, lawsOf(p), channelWeights<RossLiFormula>(p),
                     RossLiFormula::shape(Values<double>(p, 0))) {}

    std::vector<Lobe> lobes(const Direction& wo) const override {
        // A cone, whose tip is not smooth.
        return {{Lobe::About::axis, 0.01, wo}};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<RossLi>(p);
}

Parameter kernel(std::string_view name, std::string_view help, double fallback, FitRange fit) {
    return {.name = name,
            .help = help,
            .kind = Parameter::Kind::colour,
            .fallback = fallback,
            .min = 0,
            .max = 1e6,
            .fit = {fit}};
}

}  // namespace

const Model& rossLiModel() {
    static const Model model{
        .name = "ross-li",
        .help = "land surfaces as MODIS has them: RossThick and LiSparse kernels",
        .source = "Lucht, Schaaf & Strahler 2000, 10.1109/36.841980",
        .parameters = {kernel("iso", "weight of the isotropic kernel, 1", 1,
                              {.low = 0.05, .high = 1}),
                       kernel("vol", "weight of RossThick, scatter in a canopy", 0,
                              {.low = 0, .high = 0.3}),
                       kernel("geo", "weight of LiSparse, crowns and their shadows", 0,
                              {.low = 0, .high = 0.05}),
                       {.name = "hb",
                        .help = "height of the crowns' centres over their half height",
                        .fallback = 2,
                        .min = 0.1,
                        .max = 10},
                       {.name = "br",
                        .help = "half height of the crowns over their radius",
                        .fallback = 1,
                        .min = 0.1,
                        .max = 10}},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
