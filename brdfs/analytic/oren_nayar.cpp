#include <brdfs/analytic/oren_nayar.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/brdf/kink_curve.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

/// The coefficients that depend on sigma alone.
struct OrenNayarShape {
    double direct, sameSide, across, interreflected;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/oren_nayar_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalSimplified);
HWY_EXPORT(evalFull);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

OrenNayarShape shapeOf(const Parameters& p) {
    const double sigma = radians(p.number("sigma")), s = sigma * sigma;
    return {.direct = 1 - 0.5 * s / (s + 0.33),
            .sameSide = 0.45 * s / (s + 0.09),
            .across = 0.125 * s / (s + 0.09),
            .interreflected = 0.17 * s / (s + 0.13)};
}

/// simplified: the integral of cos_i max(0, cos D) sin alpha tan beta is at most pi / 2.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const OrenNayarShape r = shapeOf(p);
    const bool interreflects = p.choice("variant") == "full" && p.number("sigma") > 0;
    result.energyConserving =
        !interreflects && largest(p.colour("kd")) * (r.direct + r.sameSide / 2) <= 1;
    return result;
}

void evalSimplifiedByVectors(const OrenNayarShape& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalSimplified)(shape, batch);
}

class Simplified final
    : public ShapedBrdf<
          OrenNayarShape, evalSimplifiedByVectors,
          HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::SimplifiedTerms, OrenNayarShape>>,
      public HasKinkCurves {
public:
    explicit Simplified(const Parameters& p)
        : ShapedBrdf(
              orenNayarModel(), p, lawsOf(p),
              TermWeights{
                  mapped(p.colour("kd"), [&](double kd) { return kd / pi * shapeOf(p).direct; }),
                  {mapped(p.colour("kd"),
                          [&](double kd) { return kd / pi * shapeOf(p).sameSide; })}},
              shapeOf(p)) {}

    /// The kink at equal heights, where alpha and beta exchange the directions.
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

    /// cos D changes its sign.
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return {circleAbout({wo.x, wo.y, 0}, 0)};
    }
};

void evalFullByVectors(const OrenNayarShape& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalFull)(shape, batch);
}

class Full final
    : public ShapedBrdf<OrenNayarShape, evalFullByVectors,
                        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::FullTerms, OrenNayarShape>>,
      public HasKinkCurves {
public:
    explicit Full(const Parameters& p)
        : ShapedBrdf(orenNayarModel(), p, lawsOf(p),
                     TermWeights{{0.0},
                                 {overPi(p.colour("kd")),
                                  mapped(p.colour("kd"), [](double kd) { return kd * kd / pi; })}},
                     shapeOf(p)) {}

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
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
