#include <brdfs/analytic/phong.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <cmath>

namespace hshfit::brdfs {

struct PhongShape {
    double exponent;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/phong_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalPhong);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

double normalisation(const Parameters& p) {
    return p.choice("normalized") == "true" ? (p.number("exponent") + 2) / (2 * pi) : 1.0;
}

/// The albedo is largest at normal incidence: kd + ks N 2 pi / (exponent + 2).
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const double lobe = normalisation(p) * 2 * pi / (p.number("exponent") + 2);
    const Colour albedo = mapped(p.colour("kd"), p.colour("ks"),
                                 [&](double kd, double ks) { return kd + ks * lobe; });
    result.energyConserving = largest(albedo) <= 1;
    return result;
}

class Phong final : public TermBrdf {
public:
    explicit Phong(const Parameters& p)
        : TermBrdf(phongModel(), p, lawsOf(p), overPi(p.colour("kd")),
                   {mapped(p.colour("ks"), [&](double ks) { return ks * normalisation(p); })}),
          shape_{p.number("exponent")} {}

    std::vector<Lobe> lobes(const Direction& wo) const override {
        return {{Lobe::About::axis, 2.5 / std::sqrt(shape_.exponent + 1), mirrored(wo)}};
    }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalPhong)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::PhongTerms>(shape_, batch);
    }

private:
    PhongShape shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Phong>(p);
}

}  // namespace

const Model& phongModel() {
    static const Model model{
        .name = "phong",
        .help = "power of the cosine about the mirror direction",
        .source = "Phong 1975, 10.1145/360825.360839; Lafortune & Willems 1994, CW 197",
        .parameters = {kdParameter(0, 1e6),
                       ksParameter("scale of the lobe; its normal albedo if normalized"),
                       exponentParameter("exponent", "of cos(alpha)", {.low = 1, .high = 3e3}),
                       switchParameter("normalized", "multiply ks by (exponent + 2) / (2 pi)")},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
