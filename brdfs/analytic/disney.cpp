#include <brdfs/analytic/disney.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/sampling/visible_normals.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct DisneyAxes {
    N ax, ay;
};
template <class N>
struct DisneyShape {
    N roughness, subsurface, clearcoat, gloss;
    DisneyAxes<N> axes, masking;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/disney_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalDisney);
HWY_EXPORT(disneyColumns);

constexpr Laws claims{.nonNegative = true, .reciprocal = true, .mirrorSymmetric = true};

/// Energy conservation is known for the metallic lobe alone: F <= 1 and masking that fits Ds.
Laws lawsOf(const Parameters& p) {
    Laws laws = claims;
    const DisneyAxes<double> axes = DisneyFormula::axes(Values<double>(p, 0));
    laws.isotropic = axes.ax == axes.ay;
    laws.energyConserving =
        p.number("metallic") == 1 && p.number("clearcoat") == 0 && p.choice("masking") == "2014";
    return laws;
}

/// baseColor over its luminance: hue and saturation alone.
Colour tintOf(const Colour& base) {
    if (base.size() == 1) return {1.0};
    const double luminance = 0.3 * base[0] + 0.6 * base[1] + 0.1 * base[2];
    if (luminance == 0) return {1.0};
    return mapped(base, [&](double value) { return value / luminance; });
}

TermWeights weightsOf(const Parameters& p) {
    const Colour tint = tintOf(p.colour("baseColor"));
    TermWeights all = channelWeights<DisneyFormula>(p);
    for (std::size_t c = 0; c < tint.size(); ++c) {
        const Weights<double> own = DisneyFormula::weights(Values<double>(p, c), tint[c]);
        for (std::size_t t = 0; t < own.count; ++t) all.terms[t][c] = own.term[t];
    }
    return all;
}

void evalByVectors(const DisneyShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalDisney)(shape, batch);
}

class Disney final : public ShapedBrdf<DisneyShape<double>, evalByVectors,
                                       evalAll<double, DisneyTerms, DisneyShape<double>>> {
public:
    explicit Disney(const Parameters& p)
        : ShapedBrdf(disneyModel(), p, lawsOf(p), weightsOf(p),
                     DisneyFormula::shape(Values<double>(p, 0))) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        std::vector<Lobe> lobes{halfwayLobe(shape_.axes.ax, shape_.axes.ay)};
        if (shape_.clearcoat > 0) lobes.push_back({Lobe::About::halfway, shape_.gloss, {}});
        return lobes;
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Disney>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(disneyColumns)(request);
}

/// Tints make a channel of baseColor act on the others through its luminance.
bool withoutTints(const Parameters& stated) {
    return stated.number("specularTint") == 0 && stated.number("sheenTint") == 0;
}

Parameter unitParameter(std::string_view name, std::string_view help, double fallback) {
    return {.name = name, .help = help, .fallback = fallback, .min = 0, .max = 1};
}

Parameter unitParameter(std::string_view name, std::string_view help, double fallback,
                        const FitRange& fit) {
    return fitted(unitParameter(name, help, fallback), {fit});
}

/// Visible normals of both lobes; diffuse, flat and sheen parts fall to the cosine.
HasSamplers::Known sampling(const Parameters& p) {
    const DisneyShape<double> shape = DisneyFormula::shape(Values<double>(p, 0));
    HasSamplers::Known known{true, {ggxSampler(shape.axes.ax, shape.axes.ay)}};
    if (shape.clearcoat > 0) known.samplers.push_back(grooveSampler(gtrNormals(shape.gloss, 1)));
    return known;
}

}  // namespace

const Model& disneyModel() {
    static const Model model{
        .name = "disney",
        .help = "principled BRDF of base, specular, sheen and clearcoat lobes",
        .source =
            "Burley 2012, Physically-based shading at Disney, SIGGRAPH course notes, addenda 2014",
        .parameters =
            {{.name = "baseColor",
              .help = "linear, not a monitor value",
              .kind = Parameter::Kind::colour,
              .fallback = 0.8,
              .min = 0,
              .max = 1,
              .fit = {{.low = 0.05, .high = 0.9}},
              .linear = withoutTints},
             unitParameter("subsurface", "from the retroreflecting to the flat diffuse shape", 0,
                           {.low = 0.1, .high = 0.9}),
             unitParameter("metallic", "from a dielectric to a metal of baseColor", 0,
                           {.low = 0.1, .high = 0.9}),
             unitParameter("specular", "reflectance at normal incidence over 0.08", 0.5,
                           {.low = 0.1, .high = 0.9}),
             unitParameter("specularTint", "of the specular lobe towards baseColor's hue", 0),
             unitParameter("roughness", "square root of GGX's alpha", 0.5,
                           {.low = 0.05, .high = 0.9}),
             unitParameter("anisotropic", "stretches the lobe along x, to 10:1 or so", 0,
                           {.low = 0.1, .high = 0.9, .data = FitRange::Data::anisotropic}),
             unitParameter("sheen", "added towards grazing angles", 0, {.low = 0.1, .high = 0.9}),
             // Fits hold it at 0, which makes f linear in baseColor.
             unitParameter("sheenTint", "of the sheen towards baseColor's hue", 0.5, FitRange{}),
             unitParameter("clearcoat", "strength of a second, white lobe", 0,
                           {.low = 0.1, .high = 0.9}),
             unitParameter("clearcoatGloss", "from satin to gloss", 1, {.low = 0.1, .high = 0.9}),
             {.name = "masking",
              .help = "of the specular lobe, as revised or as first published",
              .kind = Parameter::Kind::choice,
              .choices = {"2014", "2012"}}},
        .laws = claims,
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
