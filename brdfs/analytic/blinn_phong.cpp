#include <brdfs/analytic/blinn_phong.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/sampling/visible_normals.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct BlinnPhongShape {
    N exponent;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/blinn_phong_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalBlinnPhong);
HWY_EXPORT(blinnPhongColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// The albedo is largest at normal incidence.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const Values<double> values(p, 0);
    const double lobe =
        BlinnPhongFormula::scale(values) / BlinnPhongFormula::exactFactor(values("exponent"));
    const Colour albedo = mapped(p.colour("kd"), p.colour("ks"),
                                 [&](double kd, double ks) { return kd + ks * lobe; });
    result.energyConserving = largest(albedo) <= 1;
    return result;
}

void evalByVectors(const BlinnPhongShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalBlinnPhong)(shape, batch);
}

class BlinnPhong final
    : public ShapedBrdf<BlinnPhongShape<double>, evalByVectors,
                        evalAll<double, BlinnPhongTerms, BlinnPhongShape<double>>> {
public:
    explicit BlinnPhong(const Parameters& p)
        : ShapedBrdf(blinnPhongModel(), p, lawsOf(p), channelWeights<BlinnPhongFormula>(p),
                     BlinnPhongFormula::shape(Values<double>(p, 0))) {}

    /// In the slope t the lobe is (1 + t^2)^(-n/2): nearly Gaussian, and singular at t = i.
    std::vector<Lobe> lobes(const Direction&) const override {
        return {{Lobe::About::halfway, std::min(1.0, 2.5 / std::sqrt(shape_.exponent + 1)), {}}};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<BlinnPhong>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(blinnPhongColumns)(request);
}

/// D h.z is cos^exponent; the further h.z turns surface area into projected area.
HasSamplers::Known sampling(const Parameters& p) {
    const double power = p.number("exponent") + 1;
    return {.all = true, .samplers = {grooveSampler(powerNormals(power, power))}};
}

}  // namespace

const Model& blinnPhongModel() {
    static const Model model{
        .name = "blinn-phong",
        .help = "power of the cosine between half vector and normal",
        .source = "Blinn 1977, 10.1145/563858.563893",
        .parameters = {kdParameter(0, 1e6),
                       ksParameter("scale of the lobe, 1/sr; its normal albedo if normalized"),
                       exponentParameter("exponent", "of cos(theta_h)", {.low = 1, .high = 2e4}),
                       {.name = "normalized",
                        .help = "true: a normal albedo of ks; phong: times (n + 2) / (2 pi)",
                        .kind = Parameter::Kind::choice,
                        .choices = {"false", "true", "phong"}}},
        .laws = claims,
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
