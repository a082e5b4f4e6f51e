#include <brdfs/analytic/oren_nayar.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/brdf/kink_curve.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

/// The coefficients that depend on sigma alone.
template <class N>
struct OrenNayarShape {
    N direct, sameSide, across, interreflected;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/oren_nayar_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalSimplified);
HWY_EXPORT(evalFull);
HWY_EXPORT(orenNayarColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

OrenNayarShape<double> shapeOf(const Parameters& p) {
    return orenNayarShape(Values<double>(p, 0));
}

/// simplified: the integral of cos_i max(0, cos D) sin alpha tan beta is at most pi / 2.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const OrenNayarShape<double> r = shapeOf(p);
    const bool interreflects = p.choice("variant") == "full" && p.number("sigma") > 0;
    result.energyConserving =
        !interreflects && largest(p.colour("kd")) * (r.direct + r.sameSide / 2) <= 1;
    return result;
}

void evalSimplifiedByVectors(const OrenNayarShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalSimplified)(shape, batch);
}

class Simplified final
    : public ShapedBrdf<OrenNayarShape<double>, evalSimplifiedByVectors,
                        evalAll<double, SimplifiedTerms, OrenNayarShape<double>>>,
      public HasKinkCurves {
public:
    explicit Simplified(const Parameters& p)
        : ShapedBrdf(orenNayarModel(), p, lawsOf(p), channelWeights<SimplifiedFormula>(p),
                     shapeOf(p)) {}

    /// The kink at equal heights, where alpha and beta exchange the directions.
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

    /// cos D changes its sign.
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return {circleAbout({wo.x, wo.y, 0}, 0)};
    }
};

void evalFullByVectors(const OrenNayarShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalFull)(shape, batch);
}

class Full final : public ShapedBrdf<OrenNayarShape<double>, evalFullByVectors,
                                     evalAll<double, FullTerms, OrenNayarShape<double>>>,
                   public HasKinkCurves {
public:
    explicit Full(const Parameters& p)
        : ShapedBrdf(orenNayarModel(), p, lawsOf(p), channelWeights<FullFormula>(p), shapeOf(p)) {}

    /// As for the simplified form.
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

    /// cos D changes its sign.
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return {circleAbout({wo.x, wo.y, 0}, 0)};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    if (p.choice("variant") == "full") return std::make_unique<Full>(p);
    return std::make_unique<Simplified>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(orenNayarColumns)(request);
}

}  // namespace

const Model& orenNayarModel() {
    static const Model model{
        .name = "oren-nayar",
        .help = "rough diffuse surface; simplified, or full with interreflection",
        .source = "Oren & Nayar 1994, 10.1145/192161.192213",
        .parameters = {linearIf(kdParameter(1, 1),
                                [](const Parameters& stated) {
                                    return stated.choice("variant") == "simplified";
                                }),
                       {.name = "sigma",
                        .help = "standard deviation of the groove angle, degrees",
                        .min = 0,
                        .max = 90,
                        .fit = {{.low = 5, .high = 60}}},
                       {.name = "variant",
                        .help = "Eq. 30 or Eq. 29 of the paper",
                        .kind = Parameter::Kind::choice,
                        .choices = {"simplified", "full"}}},
        .laws = claims,
        .make = make,
        .columns = columns};
    return model;
}

}  // namespace hshfit::brdfs
