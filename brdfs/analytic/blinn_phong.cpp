#include <brdfs/analytic/blinn_phong.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <cmath>

namespace hshfit::brdfs {

struct BlinnPhongShape {
    double exponent;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/blinn_phong_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalBlinnPhong);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// The factor that gives the lobe an albedo of 1 at normal incidence.
double exactFactor(double n) {
    return (n + 2) * (n + 4) / (8 * pi * (std::exp2(-n / 2) + n));
}

double normalisation(const Parameters& p) {
    const std::string normalized = p.choice("normalized");
    if (normalized == "true") return exactFactor(p.number("exponent"));
    return normalized == "phong" ? (p.number("exponent") + 2) / (2 * pi) : 1.0;
}

/// The albedo is largest at normal incidence.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const double lobe = normalisation(p) / exactFactor(p.number("exponent"));
    const Colour albedo = mapped(p.colour("kd"), p.colour("ks"),
                                 [&](double kd, double ks) { return kd + ks * lobe; });
    result.energyConserving = largest(albedo) <= 1;
    return result;
}

class BlinnPhong final : public TermBrdf {
public:
    explicit BlinnPhong(const Parameters& p)
        : TermBrdf(blinnPhongModel(), p, lawsOf(p), overPi(p.colour("kd")),
                   {mapped(p.colour("ks"), [&](double ks) { return ks * normalisation(p); })}),
          shape_{p.number("exponent")} {}

    /// In the slope t the lobe is (1 + t^2)^(-n/2): nearly Gaussian, and singular at t = i.
    std::vector<Lobe> lobes(const Direction&) const override {
        return {{Lobe::About::halfway, std::min(1.0, 2.5 / std::sqrt(shape_.exponent + 1)), {}}};
    }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalBlinnPhong)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::BlinnPhongTerms>(shape_, batch);
    }

private:
    BlinnPhongShape shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<BlinnPhong>(p);
}

}  // namespace

const Model& blinnPhongModel() {
    static const Model model{
        .name = "blinn-phong",
        .help = "power of the cosine between half vector and normal",
        .source = "Blinn 1977, 10.1145/563858.563893",
        .parameters = {kdParameter(0, 1e6),
                       ksParameter("scale of the lobe; its normal albedo if normalized"),
                       exponentParameter("exponent", "of cos(theta_h)", {.low = 1, .high = 2e4}),
                       {.name = "normalized",
                        .help = "true: a normal albedo of ks; phong: times (n + 2) / (2 pi)",
                        .kind = Parameter::Kind::choice,
                        .choices = {"false", "true", "phong"}}},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
