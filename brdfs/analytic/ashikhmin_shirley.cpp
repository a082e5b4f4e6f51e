#include <brdfs/analytic/ashikhmin_shirley.h>

#include <brdfs/analytic/fresnel.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/error.h>

#include <cmath>
#include <functional>

namespace hshfit::brdfs {

struct AshikhminShirleyShape {
    double nu, nv;
    double ior;  ///< 0: Schlick's approximation from Rs
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/ashikhmin_shirley_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalAshikhminShirley);

constexpr Laws claims{.nonNegative = true, .reciprocal = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.isotropic = p.number("nu") == p.number("nv");
    result.energyConserving = largest(p.colour("kd")) == 0 && largest(p.colour("ks")) <= 1;
    return result;
}

/// Rs, or that of the index given instead.
Colour normalReflectances(const Parameters& p) {
    const double ior = p.number("ior");
    if (ior == 0) return p.colour("Rs");
    if (p.colour("Rs") != Colour{1.0})
        throw UsageError("ashikhmin-shirley: give either Rs or ior, not both");
    return {normalReflectance(ior)};
}

/// Of lobe times F0 and lobe times Schlick's weight, or of lobe times F and nothing; of diffuse.
std::vector<Colour> weightsOf(const Parameters& p) {
    const Colour ks = p.colour("ks"), rs = normalReflectances(p);
    const Colour first = p.number("ior") == 0 ? mapped(ks, rs, std::multiplies<double>()) : ks;
    const Colour diffuse = mapped(
        p.colour("Rd"), rs, [](double rd, double f0) { return 28 * rd / (23 * pi) * (1 - f0); });
    return {first, ks, diffuse};
}

class AshikhminShirley final : public TermBrdf {
public:
    explicit AshikhminShirley(const Parameters& p)
        : TermBrdf(ashikhminShirleyModel(), p, lawsOf(p), overPi(p.colour("kd")), weightsOf(p)),
          shape_{p.number("nu"), p.number("nv"), p.number("ior")} {}

    std::vector<Lobe> lobes(const Direction&) const override {
        const auto width = [](double n) { return std::min(1.0, 2.5 / std::sqrt(n + 1)); };
        return {halfwayLobe(width(shape_.nu), width(shape_.nv))};
    }

    /// max(cos theta_i, cos theta_o).
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalAshikhminShirley)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::AshikhminShirleyTerms>(shape_, batch);
    }

private:
    AshikhminShirleyShape shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<AshikhminShirley>(p);
}

Parameter reflectance(std::string_view name, std::string_view help, double fallback) {
    return {.name = name,
            .help = help,
            .kind = Parameter::Kind::colour,
            .fallback = fallback,
            .min = 0,
            .max = 1};
}

}  // namespace

const Model& ashikhminShirleyModel() {
    static const Model model{
        .name = "ashikhmin-shirley",
        .help = "anisotropic Phong lobe with Fresnel reflectance over a coupled diffuse term",
        .source = "Ashikhmin & Shirley 2000, 10.1080/10867651.2000.10487522",
        .parameters = {fitted(reflectance("Rs", "specular reflectance at normal incidence", 1),
                              {{.low = 0.01, .high = 0.9, .unless = "ior"}}),
                       reflectance("Rd", "diffuse reflectance of the substrate", 0),
                       exponentParameter("nu", "exponent along x", {.low = 1, .high = 1e5}),
                       exponentParameter("nv", "exponent along y",
                                         {.low = 1, .high = 1e5, .follows = "nu"}),
                       {.name = "ior",
                        .help = "index of refraction, instead of Rs: exact Fresnel reflectance",
                        .fallback = 0,
                        .min = 1,
                        .max = 1000},
                       kdParameter(0, 1e6),
                       ksParameter("scale of the lobe")},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
