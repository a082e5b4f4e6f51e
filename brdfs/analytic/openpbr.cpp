#include <brdfs/analytic/openpbr.h>

#include <brdfs/analytic/openpbr_shape.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/visible_normals.h>

#include <algorithm>
#include <array>
#include <cmath>

#define HWY_TARGET_INCLUDE "brdfs/analytic/openpbr_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalOpenpbr);
HWY_EXPORT(openpbrColumns);

constexpr Laws claims{.nonNegative = true};

Laws lawsOf(const Parameters& p) {
    Laws laws = claims;
    const bool bare = p.number("coat_weight") == 0 && p.number("fuzz_weight") == 0;
    const Values<double> values(p, 0);
    const RoughnessOf<double> base = OpenpbrFormula::baseAxes(values),
                              coat = OpenpbrFormula::coatAxes(values);
    laws.isotropic = base.ax == base.ay && (p.number("coat_weight") == 0 || coat.ax == coat.ay);
    laws.mirrorSymmetric = laws.isotropic || p.number("geometry_tangent") == 0;
    laws.reciprocal = bare && p.number("base_metalness") == 1;
    // Layers scale the base by their albedos. These are known to 1e-3, and so is the sum.
    laws.energyConserving = bare && p.number("base_metalness") == 1;
    return laws;
}

void evalByVectors(const OpenpbrShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalOpenpbr)(shape, batch);
}

class Openpbr final : public ShapedBrdf<OpenpbrShape<double>, evalByVectors,
                                        evalAll<double, OpenpbrTerms, OpenpbrShape<double>>>,
                      public HasKinkCurves {
public:
    explicit Openpbr(const Parameters& p)
        : ShapedBrdf(openpbrModel(), p, lawsOf(p), channelWeights<OpenpbrFormula>(p),
                     OpenpbrFormula::shape(Values<double>(p, 0))) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        // The hint has room for x and y alone: of turned lobes the narrow width counts.
        const auto lobeOf = [&](const RoughnessOf<double>& r) {
            return halfwayLobe(shape_.sine == 0 ? r.ax : r.ay, r.ay);
        };
        std::vector<Lobe> lobes{lobeOf(shape_.base.r)};
        if (shape_.coatWeight > 0) lobes.push_back(lobeOf(shape_.coat.r));
        return lobes;
    }
    /// The kinks of the rough diffuse part, as in eon.cpp.
    std::vector<double> kinks(const Direction& wo) const override {
        if (shape_.diffuse.roughness == 0) return {};
        return {wo.z};
    }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        if (shape_.diffuse.roughness == 0) return {};
        return {circleAbout({wo.x, wo.y, 0}, 0)};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Openpbr>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(openpbrColumns)(request);
}

/// Visible normals of both lobes, and the uniform hemisphere for the fuzz.
HasSamplers::Known sampling(const Parameters& p) {
    const Values<double> values(p, 0);
    const RoughnessOf<double> base = OpenpbrFormula::baseAxes(values),
                              coat = OpenpbrFormula::coatAxes(values);
    // A turned lobe is sampled by its wider width.
    const bool turned = p.number("geometry_tangent") != 0;
    const auto samplerOf = [&](const RoughnessOf<double>& r) {
        return ggxSampler(r.ax, turned ? r.ax : r.ay);
    };
    HasSamplers::Known known{true, {samplerOf(base)}};
    if (p.number("coat_weight") > 0) known.samplers.push_back(samplerOf(coat));
    if (p.number("fuzz_weight") > 0) known.samplers.push_back(powerCosineSampler(normalAxis, 0));
    return known;
}

Parameter unit(std::string_view name, std::string_view help, double fallback,
               std::vector<FitRange> fit = {}) {
    return {.name = name, .help = help, .fallback = fallback, .min = 0, .max = 1, .fit = fit};
}

Parameter colour(std::string_view name, std::string_view help, double fallback,
                 std::vector<FitRange> fit = {}) {
    Parameter parameter = unit(name, help, fallback, std::move(fit));
    parameter.kind = Parameter::Kind::colour;
    return parameter;
}

Parameter index(std::string_view name, std::string_view help, double fallback) {
    return {.name = name,
            .help = help,
            .fallback = fallback,
            .min = 1,
            .max = 3,
            .fit = {{.low = 1.2, .high = 2.2}}};
}

/// Multiple scattering and the coat's darkening are not linear in base_color.
bool linearBase(const Parameters& stated) {
    const bool bare = stated.given("coat_weight") && stated.number("coat_weight") == 0;
    return stated.given("base_diffuse_roughness") && stated.number("base_diffuse_roughness") == 0 &&
           (bare || stated.number("coat_darkening") == 0);
}

std::vector<Parameter> parameters() {
    constexpr FitRange stretched{.low = 0.1, .high = 0.9, .data = FitRange::Data::anisotropic};
    return {
        unit("base_weight", "scale of base_color", 1),
        linearIf(colour("base_color", "diffuse albedo, or a metal's F0; linear", 0.8,
                        {{.low = 0.05, .high = 0.9}}),
                 linearBase),
        // Fits hold it, and the darkening, at 0, which makes f linear in base_color.
        unit("base_diffuse_roughness", "0 is Lambert", 0, {FitRange{}}),
        unit("base_metalness", "from a dielectric to a metal", 0, {{.low = 0.05, .high = 0.95}}),
        unit("specular_weight", "scale of the reflectance at normal incidence", 1,
             {{.low = 0.1, .high = 0.9}}),
        colour("specular_color", "of the dielectric's lobe; a metal's at 82 degrees", 1),
        unit("specular_roughness", "square root of GGX's alpha", 0.3,
             {{.low = 0.05, .high = 0.95}}),
        unit("specular_roughness_anisotropy", "widens the lobe along x", 0, {stretched}),
        {.name = "geometry_tangent",
         .help = "turn of the lobes' x about the normal, radians",
         .fallback = 0,
         .min = -2 * pi,
         .max = 2 * pi,
         .fit = {{.low = 0, .high = pi, .data = FitRange::Data::anisotropic}}},
        index("specular_ior", "of the dielectric", 1.5),
        unit("coat_weight", "presence of the coat", 0, {{.low = 0.1, .high = 0.9}}),
        colour("coat_color", "of what passes the coat twice", 1),
        unit("coat_roughness", "square root of the coat's alpha", 0, {{.low = 0.05, .high = 0.8}}),
        unit("coat_roughness_anisotropy", "widens the coat's lobe along x", 0),
        index("coat_ior", "of the coat", 1.6),
        unit("coat_darkening", "share of the reflections inside the coat", 1, {FitRange{}}),
        unit("fuzz_weight", "presence of the fuzz", 0, {{.low = 0.1, .high = 0.9}}),
        linearIf(colour("fuzz_color", "of the fuzz", 1, {{.low = 0.1, .high = 1}}), alwaysLinear),
        unit("fuzz_roughness", "of its fibres", 0.5, {{.low = 0.1, .high = 0.9}}),
        // Fits take it as stated: a film of a fit covers all facets.
        unit("thin_film_weight", "share of the base's facets under a thin film", 0),
        {.name = "thin_film_thickness",
         .help = "of the film, micrometres",
         .fallback = 0.5,
         .min = 0,
         .max = 100,
         .fit = {{.low = 0.15, .high = 0.9, .choice = "thin_film_weight"}}},
        {.name = "thin_film_ior",
         .help = "of the film",
         .fallback = 1.4,
         .min = 1,
         .max = 3,
         .fit = {{.low = 1.2, .high = 2.6, .choice = "thin_film_weight"}}}};
}

}  // namespace

const Model& openpbrModel() {
    static const Model model{
        .name = "openpbr",
        .help = "OpenPBR Surface: base, metal, thin film, coat and fuzz",
        .source = "OpenPBR Surface 1.1, Academy Software Foundation 2024",
        .parameters = parameters(),
        .laws = claims,
        .make = make,
        .columns = columns,
        .channelwise = OpenpbrFormula::coloured,
        .sampling = sampling,
        .parts = {{"specular", "strength of the dielectric's lobe", {"specular_weight"}},
                  {"ior", "index of the dielectric", {"specular_ior"}},
                  {"coat",
                   "clear layer above the base",
                   {"coat_weight", "coat_color", "coat_roughness", "coat_roughness_anisotropy",
                    "coat_ior", "coat_darkening"}},
                  {"fuzz", "fibres above all", {"fuzz_weight", "fuzz_color", "fuzz_roughness"}},
                  {"anisotropy",
                   "lobe wider along a direction of the surface",
                   {"specular_roughness_anisotropy", "geometry_tangent"}},
                  {"thin_film",
                   "interference on the base",
                   {"thin_film_weight", "thin_film_thickness", "thin_film_ior"},
                   "thin_film_weight=1"}}};
    return model;
}

}  // namespace hshfit::brdfs
