#include <brdfs/analytic/cook_torrance.h>

#include <brdfs/analytic/fresnel.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hshfit::brdfs {

struct CookTorranceShape {
    /// What one channel reflects by: F0, or the index given instead.
    struct Surface {
        double f0, inverse;  ///< 1 / eta
        double ior = 0, k = 0;
    };
    double m, peak;
    std::vector<Surface> surfaces;
    bool schlick;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/cook_torrance_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalCookTorrance);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// N of the header.
double normOf(const Parameters& p) {
    const std::string norm = p.choice("norm");
    return norm == "4" ? 4 * pi : norm == "pi" ? pi : pi * pi;
}

void checkFresnelKeys(const Parameters& p) {
    const bool conductor = p.choice("fresnel") == "conductor";
    if (p.given("ior") && p.given("F0") && p.colour("F0") != Colour{1.0})
        throw UsageError("cook-torrance: give either F0 or ior, not both");
    if (conductor && !(p.given("ior") && p.given("k")))
        throw UsageError("cook-torrance: fresnel=conductor needs ior and k");
    if (!conductor && p.given("k"))
        throw UsageError("cook-torrance: k is for fresnel=conductor alone");
}

using Surface = CookTorranceShape::Surface;

std::vector<Surface> surfacesOf(const Parameters& p) {
    checkFresnelKeys(p);
    std::vector<Surface> surfaces;
    if (!p.given("ior")) {
        for (const double f0 : p.colour("F0"))
            surfaces.push_back({f0, (1 - std::sqrt(f0)) / (1 + std::sqrt(f0))});
        return surfaces;
    }
    const Colour ior = p.colour("ior"), k = p.given("k") ? p.colour("k") : Colour{0.0};
    for (std::size_t c = 0; c < std::max(ior.size(), k.size()); ++c) {
        const double n = ior[ior.size() == 1 ? 0 : c], extinction = k[k.size() == 1 ? 0 : c];
        surfaces.push_back({normalReflectance(n, extinction), 1 / n, n, extinction});
    }
    return surfaces;
}

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const Colour albedo =
        mapped(p.colour("kd"), p.colour("ks"), [](double kd, double ks) { return kd + ks; });
    const bool noLobe = largest(p.colour("ks")) == 0;
    result.energyConserving = (p.choice("norm") == "4" || noLobe) && largest(albedo) <= 1;
    return result;
}

class CookTorrance final : public TermBrdf {
public:
    explicit CookTorrance(const Parameters& p)
        : TermBrdf(cookTorranceModel(), p, lawsOf(p), overPi(p.colour("kd")),
                   eachInItsChannel(p.colour("ks"), surfacesOf(p).size())),
          shape_{p.number("m"), 1 / (normOf(p) * p.number("m") * p.number("m")), surfacesOf(p),
                 p.choice("fresnel") == "schlick"} {}

    std::vector<Lobe> lobes(const Direction&) const override {
        return {{Lobe::About::halfway, 2.5 / std::numbers::sqrt2 * shape_.m, {}}};
    }

    /// The V-cavity term's minimum has kinks along curves that no panel can end at; 1e-6 would cost
    /// more than 2^26 evaluations at grazing angles.
    double defaultTolerance() const override { return 1e-5; }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalCookTorrance)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::CookTorranceTerms>(shape_, batch);
    }

private:
    CookTorranceShape shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<CookTorrance>(p);
}

}  // namespace

const Model& cookTorranceModel() {
    constexpr double notGiven = -1;
    static const Model model{
        .name = "cook-torrance",
        .help = "Beckmann facets in V-shaped grooves with exact Fresnel reflectance",
        .source = "Cook & Torrance 1982, 10.1145/357290.357293",
        .parameters =
            {kdParameter(0, 1e6),
             ksParameter("scale of the lobe"),
             fitted(f0Parameter(),
                    {{.low = 0.005, .high = 0.95, .choice = "fresnel=exact", .unless = "ior"},
                     {.low = 0.005, .high = 0.95, .choice = "fresnel=schlick", .unless = "ior"}}),
             {.name = "ior",
              .help = "index of refraction, instead of F0",
              .kind = Parameter::Kind::colour,
              .fallback = notGiven,
              .min = 0.01,
              .max = 1000,
              .fit = {{.low = 0.2, .high = 4, .logarithmic = true, .choice = "fresnel=conductor"}}},
             {.name = "k",
              .help = "extinction coefficient, for conductor",
              .kind = Parameter::Kind::colour,
              .fallback = notGiven,
              .min = 0,
              .max = 100,
              .fit = {{.low = 0.5, .high = 6, .choice = "fresnel=conductor"}}},
             roughnessParameter("m", "RMS slope times sqrt(2)"),
             {.name = "norm",
              .help = "divide by pi as printed, by 4 as derived since, or by pi^2",
              .kind = Parameter::Kind::choice,
              .choices = {"pi", "4", "pi2"}},
             {.name = "fresnel",
              .help = "exact for a dielectric, Schlick's, or exact for ior and k",
              .kind = Parameter::Kind::choice,
              .choices = {"exact", "schlick", "conductor"}}},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
