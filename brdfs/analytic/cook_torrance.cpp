#include <brdfs/analytic/cook_torrance.h>

#include <brdfs/analytic/fresnel.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <brdfs/analytic/v_groove.h>
#include <hshfit/error.h>

#include <cmath>
#include <numbers>

namespace hshfit::brdfs {
namespace {

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// N of the header.
double normOf(const Parameters& p) {
    const std::string norm = p.choice("norm");
    return norm == "4" ? 4 * pi : norm == "pi" ? pi : pi * pi;
}

/// F0, or that of the index given instead.
Colour normalReflectances(const Parameters& p) {
    const double ior = p.number("ior");
    if (ior == 0) return p.colour("F0");
    if (p.colour("F0") != Colour{1.0})
        throw UsageError("cook-torrance: give either F0 or ior, not both");
    return {normalReflectance(ior)};
}

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const Colour albedo =
        mapped(p.colour("kd"), p.colour("ks"), [](double kd, double ks) { return kd + ks; });
    const bool noLobe = largest(p.colour("ks")) == 0;
    result.energyConserving = (p.choice("norm") == "4" || noLobe) && largest(albedo) <= 1;
    return result;
}

/// One term per value of F0, weighted by ks in its own channel only.
std::vector<Colour> weightsOf(const Parameters& p) {
    const Colour ks = p.colour("ks");
    const std::size_t count = normalReflectances(p).size();
    if (count == 1) return {ks};
    std::vector<Colour> weights;
    for (std::size_t c = 0; c < count; ++c) {
        weights.push_back(Colour(count, 0.0));
        weights.back()[c] = ks[ks.size() == 1 ? 0 : c];
    }
    return weights;
}

/// Fresnel's reflectance for unpolarised light; `inverse` is 1 / eta, so that a perfect mirror
/// (eta = infinity) is nothing special. Cook & Torrance's formula, times inverse throughout.
double fresnel(double inverse, double cosine) {
    // Below 1e-150 its square underflows; F has long been 1 (or 0 for eta = 1).
    const double c = std::max(cosine, 1e-150);
    const double ec = inverse * c;
    const double g = std::sqrt((1 - inverse) * (1 + inverse) + ec * ec);
    const double a = (g - ec) / (g + ec);
    const double b = (c * (g + ec) - inverse) / (c * (g - ec) + inverse);
    return 0.5 * a * a * (1 + b * b);
}

class CookTorrance final : public TermBrdf {
public:
    explicit CookTorrance(const Parameters& p)
        : TermBrdf(cookTorranceModel(), p, lawsOf(p), overPi(p.colour("kd")), weightsOf(p)),
          m_(p.number("m")),
          peak_(1 / (normOf(p) * m_ * m_)),
          reflectances_(normalReflectances(p)),
          inverses_(mapped(reflectances_, [](double f0) { return 1 / iorOfReflectance(f0); })),
          schlick_(p.choice("fresnel") == "schlick") {}

    std::vector<Lobe> lobes(const Direction&) const override {
        return {{Lobe::About::halfway, 2.5 / std::numbers::sqrt2 * m_, {}}};
    }

    /// The V-cavity term's minimum has kinks along curves that no panel can end at; 1e-6 would cost
    /// more than 2^26 evaluations at grazing angles.
    double defaultTolerance() const override { return 1e-5; }

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k) {
            const HalfVector h(wo, wi.x[k], wi.y[k], wi.z[k]);
            const double squaredSlope = h.squaredSlope();
            const double rise = 1 + squaredSlope;
            const double density = peak_ * std::exp(-squaredSlope / (m_ * m_)) * rise * rise;
            const double cosine = h.dotOutgoing();
            const double lobe = bounded(density * bounded(vGrooveVisibility(h, wi.z[k], wo.z)));
            for (std::size_t c = 0; c < inverses_.size(); ++c)
                out[c * wi.count + k] =
                    lobe * (schlick_ ? schlickReflectance(cosine, reflectances_[c])
                                     : fresnel(inverses_[c], cosine));
        }
    }

private:
    double m_, peak_;
    Colour reflectances_;
    Colour inverses_;  ///< 1 / eta
    bool schlick_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<CookTorrance>(p);
}

}  // namespace

const Model& cookTorranceModel() {
    static const Model model{
        .name = "cook-torrance",
        .help = "Beckmann facets in V-shaped grooves with exact Fresnel reflectance",
        .source = "Cook & Torrance 1982, 10.1145/357290.357293",
        .parameters = {kdParameter(0, 1e6),
                       ksParameter("scale of the lobe"),
                       f0Parameter(),
                       {.name = "ior",
                        .help = "index of refraction, instead of F0",
                        .fallback = 0,
                        .min = 1,
                        .max = 1000},
                       roughnessParameter("m", "RMS slope times sqrt(2)"),
                       {.name = "norm",
                        .help = "divide by pi as printed, by 4 as derived since, or by pi^2",
                        .kind = Parameter::Kind::choice,
                        .choices = {"pi", "4", "pi2"}},
                       {.name = "fresnel",
                        .help = "exact for a dielectric, or Schlick's approximation",
                        .kind = Parameter::Kind::choice,
                        .choices = {"exact", "schlick"}}},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
