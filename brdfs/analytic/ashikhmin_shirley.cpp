#include <brdfs/analytic/ashikhmin_shirley.h>

#include <brdfs/analytic/fresnel.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/error.h>

#include <cmath>
#include <functional>

namespace hshfit::brdfs {
namespace {

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

/// 1 - (1 - c/2)^5.
double diffuseFalloff(double cosine) {
    return 1 - schlickWeight(cosine / 2);
}

class AshikhminShirley final : public TermBrdf {
public:
    explicit AshikhminShirley(const Parameters& p)
        : TermBrdf(ashikhminShirleyModel(), p, lawsOf(p), overPi(p.colour("kd")), weightsOf(p)),
          nu_(p.number("nu")),
          nv_(p.number("nv")),
          ior_(p.number("ior")) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        const auto width = [](double n) { return std::min(1.0, 2.5 / std::sqrt(n + 1)); };
        return {{Lobe::About::halfway, width(std::max(nu_, nv_)), {}, width(std::min(nu_, nv_))}};
    }

    /// max(cos theta_i, cos theta_o).
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        const double peak = std::sqrt((nu_ + 1) * (nv_ + 1)) / (8 * pi);
        const double outgoingFalloff = diffuseFalloff(wo.z);
        for (std::size_t k = 0; k < wi.count; ++k) {
            const HalfVector h(wo, wi.x[k], wi.y[k], wi.z[k]);
            const double squaredSlope = h.squaredSlope();
            // log((h.z)^-2) per squared slope: log1p(t^2) / t^2.
            const double perSlope = squaredSlope > 0 ? std::log1p(squaredSlope) / squaredSlope : 1;
            const double tx = h.slopeX(), ty = h.slopeY();
            const double power = std::exp(-0.5 * (nu_ * tx * tx + nv_ * ty * ty) * perSlope);
            const double cosine = h.dotOutgoing();
            const double lobe = bounded(peak * power / cosine / std::max(wi.z[k], wo.z));
            const double weight = ior_ == 0 ? schlickWeight(cosine) : 0;
            out[k] = lobe * (ior_ == 0 ? 1 - weight : dielectricReflectance(cosine, ior_));
            out[wi.count + k] = lobe * weight;
            out[2 * wi.count + k] = diffuseFalloff(wi.z[k]) * outgoingFalloff;
        }
    }

private:
    double nu_, nv_;
    double ior_;  ///< 0: Schlick's approximation from Rs
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
