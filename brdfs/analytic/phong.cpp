#include <brdfs/analytic/phong.h>

#include <brdfs/analytic/kink_curves.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/sampling/axis_lobes.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct PhongShape {
    N exponent;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/phong_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalPhong);
HWY_EXPORT(phongColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// The albedo is largest at normal incidence: kd + ks N 2 pi / (exponent + 2).
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const double lobe =
        PhongFormula::scale(Values<double>(p, 0)) * 2 * pi / (p.number("exponent") + 2);
    const Colour albedo = mapped(p.colour("kd"), p.colour("ks"),
                                 [&](double kd, double ks) { return kd + ks * lobe; });
    result.energyConserving = largest(albedo) <= 1;
    return result;
}

void evalByVectors(const PhongShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalPhong)(shape, batch);
}

class Phong final : public ShapedBrdf<PhongShape<double>, evalByVectors,
                                      evalAll<double, PhongTerms, PhongShape<double>>>,
                    public HasKinkCurves {
public:
    explicit Phong(const Parameters& p)
        : ShapedBrdf(phongModel(), p, lawsOf(p), channelWeights<PhongFormula>(p),
                     PhongFormula::shape(Values<double>(p, 0))) {}

    std::vector<Lobe> lobes(const Direction& wo) const override {
        return {{Lobe::About::axis, 2.5 / std::sqrt(shape_.exponent + 1), mirrored(wo)}};
    }

    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return clampedPowerKinks(mirrored(wo), shape_.exponent);
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Phong>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(phongColumns)(request);
}

/// Exact up to cos(theta_i).
HasSamplers::Known sampling(const Parameters& p) {
    return {.all = true, .samplers = {powerCosineSampler(mirrorAxis, p.number("exponent"))}};
}

}  // namespace

const Model& phongModel() {
    static const Model model{
        .name = "phong",
        .help = "power of the cosine about the mirror direction",
        .source = "Phong 1975, 10.1145/360825.360839; Lafortune & Willems 1994, CW 197",
        .parameters = {kdParameter(0, 1e6),
                       ksParameter("scale of the lobe, 1/sr; its normal albedo if normalized"),
                       exponentParameter("exponent", "of cos(alpha)", {.low = 1, .high = 3e3}),
                       switchParameter("normalized", "multiply ks by (exponent + 2) / (2 pi)")},
        .laws = claims,
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
