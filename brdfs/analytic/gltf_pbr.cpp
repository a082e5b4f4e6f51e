#include <brdfs/analytic/gltf_pbr.h>

#include <brdfs/analytic/charlie_shape.h>
#include <brdfs/analytic/facet_normals.h>
#include <brdfs/analytic/ggx_shape.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/sheen_albedo.h>
#include <brdfs/analytic/term_brdf.h>
#include <brdfs/analytic/thin_film.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/visible_normals.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view facet_smooth;
}  // namespace hshfit::embedded

namespace hshfit::brdfs {

template <class N>
struct GltfPbrShape {
    GgxShape<N> base, coat;
    N cosine, sine;  ///< of the anisotropy's rotation
    N specular, f0;  ///< of the dielectric; f0 the largest of the channels
    N clearcoat;
    N sheen, sheenPeak;  ///< whether there is sheen; the largest channel of its colour
    CharlieCurve<N> curve;
    std::array<N, SheenAlbedoTable::Row().size()> albedo;
    std::array<N, 3> f0Of;  ///< f0 of each channel, under a film
    FilmShape<N> film;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/gltf_pbr_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalGltfPbr);
HWY_EXPORT(gltfPbrColumns);

constexpr Laws claims{.nonNegative = true};

Laws lawsOf(const Parameters& p) {
    Laws laws = claims;
    const bool coated = p.number("clearcoatFactor") > 0;
    laws.reciprocal = !coated;
    laws.isotropic = p.number("anisotropyStrength") == 0 || p.number("roughnessFactor") == 1;
    laws.mirrorSymmetric = laws.isotropic || p.number("anisotropyRotation") == 0;
    laws.energyConserving =
        p.number("metallicFactor") == 1 && largest(p.colour("sheenColorFactor")) == 0;
    return laws;
}

GltfPbrShape<double> shapeOf(const Parameters& p) {
    GltfPbrShape<double> shape = GltfPbrFormula::shape(Values<double>(p, 0));
    shape.f0 = std::min(
        1.0, normalReflectanceOf(p.number("ior"), 0.0) * largest(p.colour("specularColorFactor")));
    shape.sheen = shape.sheenPeak = largest(p.colour("sheenColorFactor"));
    if (shape.sheen > 0) {
        GltfPbrFormula::setAlbedo(
            std::max(SheenAlbedoTable::leastRoughness, p.number("sheenRoughnessFactor")), shape);
    }
    return shape;
}

void evalByVectors(const GltfPbrShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalGltfPbr)(shape, batch);
}

/// By how much the second derivative jumps at a node of Catmull and Rom's cubics, per step squared.
double curvatureJump(const double* node) {
    return std::abs(node[-2] - 2 * node[-1] + 2 * node[1] - node[2]);
}

class GltfPbr : public ShapedBrdf<GltfPbrShape<double>, evalByVectors,
                                  evalAll<double, GltfPbrTerms, GltfPbrShape<double>>> {
public:
    explicit GltfPbr(const Parameters& p)
        : ShapedBrdf(gltfPbrModel(), p, lawsOf(p), channelWeights<GltfPbrFormula>(p), shapeOf(p)) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        const RoughnessOf<double>& r = shape_.base.r;
        std::vector<Lobe> lobes{halfwayLobe(r.ax, r.ay)};
        // The hint has room for x and y alone: of a turned lobe the narrow width counts.
        if (shape_.sine != 0 && r.ax != r.ay) lobes[0] = halfwayLobe(r.ay, r.ay);
        if (shape_.clearcoat > 0) lobes.push_back(halfwayLobe(shape_.coat.r.ax, shape_.coat.r.ay));
        if (shape_.sheen > 0) lobes.push_back({Lobe::About::halfway, 0.5, {}});
        return lobes;
    }

    /// Charlie's masking has a kink at 60 degrees; the base is scaled by the larger of two albedos,
    /// which are cubics between the nodes of a table.
    std::vector<double> kinks(const Direction& wo) const override {
        if (shape_.sheen == 0) return {};
        std::vector<double> heights = {0.5, wo.z};
        for (int k = 1; k < SheenAlbedoTable::steps; ++k) {
            // A smaller jump of the curvature, per step squared, moves integrals by less than 1e-7.
            constexpr double least = 1e-6;
            if (shape_.sheenPeak * curvatureJump(shape_.albedo.data() + k + 1) < least) continue;
            const double root = static_cast<double>(k) / SheenAlbedoTable::steps;
            heights.push_back(root * root);
        }
        return heights;
    }
    double defaultTolerance() const override {
        return shape_.sheen > 0 || shape_.film.weight > 0 ? 1e-5 : ShapedBrdf::defaultTolerance();
    }
};

FacetText textOf(const Parameters& p) {
    FacetText text = facetText({{"roughness", "roughnessFactor", p.number("roughnessFactor")},
                                {"strength", "anisotropyStrength", p.number("anisotropyStrength")},
                                {"strengthOfF0", "specularFactor", p.number("specularFactor")},
                                {"ior", "ior", p.number("ior")},
                                {"colour", "", largest(p.colour("specularColorFactor"))}},
                               {"smith", "squared", "correlated", "schlick"});
    text.smooth = embedded::facet_smooth;
    return text;
}

std::unique_ptr<Brdf> make(const Parameters& p) {
    const GltfPbrShape<double> shape = shapeOf(p);
    // A coat is a second lobe, sheen has a peak of its own, and a film colours the facets.
    if (shape.clearcoat > 0 || shape.sheen > 0 || shape.film.weight > 0)
        return std::make_unique<GltfPbr>(p);
    const RoughnessOf<double>& r = shape.base.r;
    return std::make_unique<WithFacetNormals<GltfPbr>>(
        FacetNormals{.density = ggxNormals(r.ax, r.ay),
                     .widthX = r.ax,
                     .widthY = r.ay,
                     .turn = p.number("anisotropyRotation"),
                     .weights = channelWeights<GltfPbrFormula>(p),
                     .ofLobe = {false, true, true, false, false, false, false, false},
                     .text = textOf(p)},
        p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(gltfPbrColumns)(request);
}

/// Visible normals of both lobes, of a turned one by its wider width, and the uniform hemisphere
/// for the sheen; the diffuse part falls to the cosine.
HasSamplers::Known sampling(const Parameters& p) {
    const GltfPbrShape<double> shape = shapeOf(p);
    const RoughnessOf<double>& r = shape.base.r;
    HasSamplers::Known known{true, {ggxSampler(r.ax, shape.sine == 0 ? r.ay : r.ax)}};
    if (shape.clearcoat > 0) known.samplers.push_back(ggxSampler(shape.coat.r.ax, shape.coat.r.ay));
    if (shape.sheen > 0) known.samplers.push_back(powerCosineSampler(normalAxis, 0));
    return known;
}

Parameter unit(std::string_view name, std::string_view help, double fallback,
               std::vector<FitRange> fit) {
    return {.name = name, .help = help, .fallback = fallback, .min = 0, .max = 1, .fit = fit};
}

Parameter colour(std::string_view name, std::string_view help, double fallback,
                 std::vector<FitRange> fit) {
    Parameter parameter = unit(name, help, fallback, std::move(fit));
    parameter.kind = Parameter::Kind::colour;
    return parameter;
}

std::vector<Parameter> parameters() {
    constexpr auto anisotropic = FitRange::Data::anisotropic;
    return {
        inRole(linearIf(colour("baseColorFactor", "diffuse albedo, or a metal's F0; linear", 1,
                               {{.low = 0.05, .high = 0.9}}),
                        alwaysLinear),
               Parameter::Role::weight),
        inRole(unit("metallicFactor", "from a dielectric to a metal", 1,
                    {{.low = 0.05, .high = 0.95}}),
               Parameter::Role::weight),
        unit("roughnessFactor", "square root of GGX's alpha", 1, {{.low = 0.05, .high = 0.95}}),
        {.name = "ior",
         .help = "of the dielectric",
         .fallback = 1.5,
         .min = 1,
         .max = 100,
         .fit = {{.low = 1.2, .high = 2.2}},
         .role = Parameter::Role::both},
        inRole(unit("specularFactor", "strength of the dielectric's lobe", 1,
                    {{.low = 0.1, .high = 0.9}}),
               Parameter::Role::both),
        // Not fitted: a colour here darkens the diffuse parts of all channels, as no column does.
        inRole(colour("specularColorFactor", "scale of the dielectric's F0", 1, {}),
               Parameter::Role::both),
        colour("sheenColorFactor", "of the cloth's fibres", 0, {{.low = 0.02, .high = 0.8}}),
        unit("sheenRoughnessFactor", "square root of charlie's r", 0, {{.low = 0.2, .high = 0.9}}),
        unit("clearcoatFactor", "strength of the coat", 0, {{.low = 0.1, .high = 0.9}}),
        unit("clearcoatRoughnessFactor", "square root of the coat's alpha", 0,
             {{.low = 0.05, .high = 0.8}}),
        unit("anisotropyStrength", "widens the lobe along its direction", 0,
             {{.low = 0.1, .high = 0.9, .data = anisotropic}}),
        {.name = "anisotropyRotation",
         .help = "of that direction from the tangent, radians",
         .fallback = 0,
         .min = -2 * pi,
         .max = 2 * pi,
         .fit = {{.low = 0, .high = pi, .data = anisotropic}},
         .role = Parameter::Role::turn},
        // Fits take it as stated: a film of a fit covers all facets.
        unit("iridescenceFactor", "share of the facets under a thin film", 0, {}),
        {.name = "iridescenceIor",
         .help = "of the film",
         .fallback = 1.3,
         .min = 1,
         .max = 100,
         .fit = {{.low = 1.2, .high = 2.6, .choice = "iridescenceFactor"}}},
        {.name = "iridescenceThickness",
         .help = "of the film, nm",
         .fallback = 400,
         .min = 0,
         .max = 1e5,
         .fit = {{.low = 150, .high = 900, .choice = "iridescenceFactor"}}},
    };
}

}  // namespace

const Model& gltfPbrModel() {
    static const Model model{
        .name = "gltf-pbr",
        .help = "material of glTF 2.0, with its ratified extensions",
        .source = "Khronos 2021, glTF 2.0 specification, appendix B; KHR_materials_*",
        .parameters = parameters(),
        .laws = claims,
        .make = make,
        .columns = columns,
        .channelwise = GltfPbrFormula::coloured,
        .sampling = sampling,
        .parts = {{"ior", "KHR_materials_ior", {"ior"}},
                  {"specular", "KHR_materials_specular", {"specularFactor", "specularColorFactor"}},
                  {"sheen", "KHR_materials_sheen", {"sheenColorFactor", "sheenRoughnessFactor"}},
                  {"clearcoat",
                   "KHR_materials_clearcoat",
                   {"clearcoatFactor", "clearcoatRoughnessFactor"}},
                  {"anisotropy",
                   "KHR_materials_anisotropy",
                   {"anisotropyStrength", "anisotropyRotation"}},
                  {"iridescence",
                   "KHR_materials_iridescence",
                   {"iridescenceFactor", "iridescenceIor", "iridescenceThickness"},
                   "iridescenceFactor=1"}}};
    return model;
}

}  // namespace hshfit::brdfs
