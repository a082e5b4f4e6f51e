#include <brdfs/analytic/cook_torrance.h>

#include <brdfs/analytic/kink_curves.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/error.h>
#include <hshfit/sampling/visible_normals.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hshfit::brdfs {

/// The reflectance of one channel: F0, or the index given instead.
template <class N>
struct CookTorranceSurface {
    N f0, inverse;  ///< 1 / eta
    N ior, k;       ///< 0: not given
};
template <class N>
struct CookTorranceShape {
    N m, peak;
    std::vector<CookTorranceSurface<N>> surfaces;
    bool schlick;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/cook_torrance_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalCookTorrance);
HWY_EXPORT(cookTorranceColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

void checkFresnelKeys(const Parameters& p) {
    const bool conductor = p.choice("fresnel") == "conductor";
    if (p.given("ior") && p.given("F0") && p.colour("F0") != Colour{1.0})
        throw UsageError("cook-torrance: give either F0 or ior, not both");
    if (conductor && !(p.given("ior") && p.given("k")))
        throw UsageError("cook-torrance: fresnel=conductor needs ior and k");
    if (!conductor && p.given("k"))
        throw UsageError("cook-torrance: k is for fresnel=conductor alone");
}

CookTorranceShape<double> shapeOf(const Parameters& p) {
    checkFresnelKeys(p);
    std::size_t surfaces = 1;
    for (const char* name : {"F0", "ior", "k"})
        surfaces = std::max(surfaces, p.colour(name).size());
    CookTorranceShape<double> shape = CookTorranceFormula::shape(Values<double>(p, 0));
    for (std::size_t c = 1; c < surfaces; ++c)
        shape.surfaces.push_back(CookTorranceFormula::surface(Values<double>(p, c)));
    return shape;
}

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const Colour albedo =
        mapped(p.colour("kd"), p.colour("ks"), [](double kd, double ks) { return kd + ks; });
    const bool noLobe = largest(p.colour("ks")) == 0;
    result.energyConserving = (p.choice("norm") == "4" || noLobe) && largest(albedo) <= 1;
    return result;
}

void evalByVectors(const CookTorranceShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalCookTorrance)(shape, batch);
}

class CookTorrance final
    : public ShapedBrdf<CookTorranceShape<double>, evalByVectors,
                        evalAll<double, CookTorranceTerms, CookTorranceShape<double>>>,
      public HasKinkCurves {
public:
    CookTorrance(const Parameters& p, const CookTorranceShape<double>& shape)
        : ShapedBrdf(cookTorranceModel(), p, lawsOf(p),
                     TermWeights{overPi(p.colour("kd")),
                                 eachInItsChannel(p.colour("ks"), shape.surfaces.size())},
                     shape) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        return {{Lobe::About::halfway, 2.5 / std::numbers::sqrt2 * shape_.m, {}}};
    }

    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        std::vector<KinkCurve> curves = vGrooveKinks(wo);
        if (shape_.schlick) return curves;
        for (const CookTorranceSurface<double>& surface : shape_.surfaces) {
            if (surface.ior <= 0 || surface.k > 0) continue;
            for (const KinkCurve& curve : totalReflectionKinks(wo, {&surface.ior, 1}))
                curves.push_back(curve);
        }
        return curves;
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<CookTorrance>(p, shapeOf(p));
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(cookTorranceColumns)(request);
}

/// Exact up to Fresnel's factor and the masking of wi: these are the visible normals of grooves.
HasSamplers::Known sampling(const Parameters& p) {
    return {.all = true,
            .samplers = {grooveSampler(gaussianNormals(p.number("m"), p.number("m")))}};
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
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
