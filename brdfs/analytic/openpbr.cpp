#include <brdfs/analytic/openpbr.h>

#include <brdfs/analytic/eon_shape.h>
#include <brdfs/analytic/fresnel.h>
#include <brdfs/analytic/ggx_shape.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/visible_normals.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::brdfs {

/// Directional albedo of facets with exact Fresnel reflectance and correlated masking, over
/// sqrt(cos theta); midpoints over visible normals (Heitz 2018, JCGT 7(4)).
class FacetAlbedo {
public:
    FacetAlbedo() = default;
    FacetAlbedo(double alpha, double ior) {
        for (int k = 0; k <= steps; ++k) {
            const double root = std::max(static_cast<double>(k) / steps, 1e-3);
            values_[k + 1] = at(alpha, ior, root * root);
        }
        values_.front() = 2 * values_[1] - values_[2];
        values_.back() = 2 * values_[steps + 1] - values_[steps];
    }

    double operator()(double cosine) const {
        const double x = std::sqrt(std::clamp(cosine, 0.0, 1.0)) * steps;
        const int k = std::min(static_cast<int>(x), steps - 1);
        const double t = x - k, a = values_[k], b = values_[k + 1], c = values_[k + 2],
                     d = values_[k + 3];
        const double cubic = 3 * (b - c) + d - a, square = 2 * a - 5 * b + 4 * c - d;
        return std::clamp(b + 0.5 * t * (c - a + t * (square + t * cubic)), 0.0, 1.0);
    }

private:
    static constexpr int steps = 24;

    static double at(double alpha, double ior, double zo) {
        // Of one half: the other is its mirror image.
        constexpr int rings = 16, azimuths = 10;
        const double xo = std::sqrt(1 - zo * zo);
        const auto lambda = [&](double x2, double z) {
            return 0.5 * (std::sqrt(1 + alpha * alpha * x2 / (z * z)) - 1);
        };
        const double stretched = std::hypot(alpha * xo, zo);
        const double vx = alpha * xo / stretched, vz = zo / stretched;
        const double outgoing = lambda(xo * xo, zo);
        double sum = 0;
        for (int i = 0; i < rings; ++i) {
            const double radius = std::sqrt((i + 0.5) / rings);
            for (int j = 0; j < azimuths; ++j) {
                const double phi = pi * ((j + 0.5) / azimuths - 0.5);
                const double t1 = radius * std::cos(phi), half = 0.5 * (1 + vz);
                const double t2 =
                    (1 - half) * std::sqrt(1 - t1 * t1) + half * radius * std::sin(phi);
                const double t3 = std::sqrt(std::max(0.0, 1 - t1 * t1 - t2 * t2));
                // T1 is +y, T2 the rest of the frame about the stretched direction.
                double x = alpha * (-t2 * vz + t3 * vx), y = alpha * t1,
                       z = std::max(0.0, t2 * vx + t3 * vz);
                const double length = std::sqrt(x * x + y * y + z * z);
                x /= length, y /= length, z /= length;
                const double cosine = x * xo + z * zo, zi = 2 * cosine * z - zo;
                if (zi <= 0 || cosine <= 0) continue;
                const double incoming = lambda(1 - zi * zi, zi);
                sum += dielectricReflectance(std::min(1.0, cosine), ior) * (1 + outgoing) /
                       (1 + outgoing + incoming);
            }
        }
        return sum / (rings * azimuths);
    }

    std::array<double, steps + 3> values_{};
};

/// Of the fuzz for one wo: its albedo, the matrix, and the azimuth of wo.
struct OpenpbrFuzz {
    double albedo, a, b, x, y;
};
/// Factors of the layers for one wo.
struct OpenpbrLayers {
    double coat, under, diffuse;
    OpenpbrFuzz fuzz;
};

struct OpenpbrShape {
    GgxShape<double> base, coat;
    EonShape diffuse;
    double eta, coatEta, coatWeight, fuzzWeight, fuzzRoughness;
    FacetAlbedo specularAlbedo, coatAlbedo;

    OpenpbrLayers layersAt(const Direction& wo) const {
        const OpenpbrFuzz fuzz = fuzzAt(wo);
        const double below = 1 - fuzzWeight * fuzz.albedo;
        const double under = below * (coatWeight > 0 ? 1 - coatWeight * coatAlbedo(wo.z) : 1);
        return {below, under, under * (1 - specularAlbedo(wo.z)), fuzz};
    }

private:
    /// MaterialX's fits to the authors' tables.
    OpenpbrFuzz fuzzAt(const Direction& wo) const {
        if (fuzzWeight == 0) return {0, 1, 0, 1, 0};
        const double x = wo.z, y = fuzzRoughness;
        const double width = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y));
        const double middle =
            y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y * y))) / (0.046391 + y);
        const double rest =
            y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y));
        const double away = (x - middle) / width;
        const double albedo = std::exp(-0.5 * away * away) / (width * std::sqrt(2 * pi)) + rest;
        const double a =
            (2.58126 * x + 0.813703 * y) * y / (1 + 0.310327 * x * x + 2.60994 * x * y);
        const double b = std::sqrt(std::max(0.0, 1 - x)) * (y - 1) * y * y * y /
                         (0.0000254053 + 1.71228 * x - 1.71506 * x * y + 1.34174 * y * y);
        const double sine = std::hypot(wo.x, wo.y);
        return {std::clamp(albedo, 0.0, 1.0), a, b, sine > 0 ? wo.x / sine : 1,
                sine > 0 ? wo.y / sine : 0};
    }
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/openpbr_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalOpenpbr);

double mix(double a, double b, double share) {
    return a + (b - a) * share;
}

RoughnessOf<double> axesOf(double roughness, double anisotropy) {
    const double across = 1 - anisotropy;
    const double along = roughness * roughness * std::sqrt(2 / (1 + across * across));
    return {std::max(1e-4, along), std::max(1e-4, across * along)};
}

double averageOf(const RoughnessOf<double>& r) {
    return std::sqrt(r.ax * r.ay);
}

/// The index of the base, against air or the coat, whose reflectance at normal incidence
/// specular_weight scales.
double etaOf(const Parameters& p) {
    const double ior = p.number("specular_ior"), ratio = ior / p.number("coat_ior");
    const double eta = mix(ior, std::max(ratio, 1 / ratio), p.number("coat_weight"));
    const double root =
        std::sqrt(std::min(p.number("specular_weight") * normalReflectance(eta), 0.99999));
    return (1 + root) / (1 - root);
}

OpenpbrShape shapeOf(const Parameters& p) {
    const double coated = p.number("coat_weight"), roughness = p.number("specular_roughness");
    const double fourth = std::pow(roughness, 4) + 2 * std::pow(p.number("coat_roughness"), 4);
    const double rougher = mix(roughness, std::pow(std::min(1.0, fourth), 0.25), coated);
    OpenpbrShape shape{
        .base = {axesOf(rougher, p.number("specular_roughness_anisotropy"))},
        .coat = {axesOf(p.number("coat_roughness"), p.number("coat_roughness_anisotropy"))},
        .diffuse = EonSettings{p.number("base_diffuse_roughness"), true}.shape(),
        .eta = etaOf(p),
        .coatEta = p.number("coat_ior"),
        .coatWeight = coated,
        .fuzzWeight = p.number("fuzz_weight"),
        .fuzzRoughness = std::max(0.01, p.number("fuzz_roughness")),
        .specularAlbedo = {},
        .coatAlbedo = {}};
    if (p.number("base_metalness") < 1)
        shape.specularAlbedo = FacetAlbedo(averageOf(shape.base.r), shape.eta);
    if (coated > 0) shape.coatAlbedo = FacetAlbedo(averageOf(shape.coat.r), shape.coatEta);
    return shape;
}

constexpr Laws claims{.nonNegative = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws laws = claims;
    const bool bare = p.number("coat_weight") == 0 && p.number("fuzz_weight") == 0;
    const OpenpbrShape shape = shapeOf(p);
    laws.isotropic = shape.base.r.ax == shape.base.r.ay &&
                     (shape.coatWeight == 0 || shape.coat.r.ax == shape.coat.r.ay);
    laws.reciprocal = bare && p.number("base_metalness") == 1;
    // Under layers the sum is that of their albedos, which are known to 1e-3.
    laws.energyConserving = bare && p.number("base_metalness") == 1;
    return laws;
}

/// The colour that the coat gives to the layers under it.
Colour tintOf(const Parameters& p) {
    const double weight = p.number("coat_weight"), ior = p.number("coat_ior");
    const double inside = 1 - (1 - normalReflectance(ior)) / (ior * ior);
    const double share = weight * p.number("coat_darkening");
    const double scale = mix(1, p.number("specular_weight"), p.number("base_metalness"));
    return mapped(p.colour("coat_color"), p.colour("base_color"), [&](double coat, double base) {
        return mix(1, coat, weight) * mix(1, (1 - inside) / (1 - scale * base * inside), share);
    });
}

TermWeights weightsOf(const Parameters& p) {
    const double metal = p.number("base_metalness"), specular = p.number("specular_weight");
    const Colour tint = tintOf(p), edge = p.colour("specular_color");
    const Colour base = mapped(p.colour("base_color"),
                               [&](double colour) { return p.number("base_weight") * colour; });
    const auto under = [&](const Colour& colour, double weight) {
        return mapped(colour, tint, [&](double a, double b) { return weight * a * b; });
    };
    const EonSettings diffuse{p.number("base_diffuse_roughness"), true};
    constexpr double cosine = 1. / 7;
    const double rise = schlickWeight(cosine), bend = cosine * rise * (1 - cosine);
    const Colour dip = mapped(base, edge, [&](double f0, double f82) {
        return -(f0 + (1 - f0) * rise) * (1 - specular * f82) / bend;
    });
    const double fuzzed = p.number("fuzz_weight");
    return {{0.0},
            {under(overPi(base), 1 - metal),
             under(diffuse.multiple(base), 1 - metal),
             under(edge, 1 - metal),
             under(base, metal * specular),
             under({1.0}, metal * specular),
             under(dip, metal * specular),
             {p.number("coat_weight")},
             mapped(p.colour("fuzz_color"), [&](double colour) { return fuzzed * colour; })}};
}

void evalByVectors(const OpenpbrShape& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalOpenpbr)(shape, batch);
}

class Openpbr final
    : public ShapedBrdf<OpenpbrShape, evalByVectors,
                        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::OpenpbrTerms, OpenpbrShape>>,
      public HasKinkCurves {
public:
    explicit Openpbr(const Parameters& p)
        : ShapedBrdf(openpbrModel(), p, lawsOf(p), weightsOf(p), shapeOf(p)) {}

    std::vector<Lobe> lobes(const Direction&) const override {
        std::vector<Lobe> lobes{halfwayLobe(shape_.base.r.ax, shape_.base.r.ay)};
        if (shape_.coatWeight > 0) lobes.push_back(halfwayLobe(shape_.coat.r.ax, shape_.coat.r.ay));
        return lobes;
    }
    /// Those of the rough diffuse part, as in eon.cpp.
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

/// Visible normals of both lobes, and the uniform hemisphere for the fuzz.
HasSamplers::Known sampling(const Parameters& p) {
    const RoughnessOf<double> coat =
        axesOf(p.number("coat_roughness"), p.number("coat_roughness_anisotropy"));
    const OpenpbrShape shape = shapeOf(p);
    HasSamplers::Known known{true, {ggxSampler(shape.base.r.ax, shape.base.r.ay)}};
    if (shape.coatWeight > 0) known.samplers.push_back(ggxSampler(coat.ax, coat.ay));
    if (shape.fuzzWeight > 0) known.samplers.push_back(powerCosineSampler(normalAxis, 0));
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
            .fit = {{.low = 1.1, .high = 2.5}}};
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
        index("specular_ior", "of the dielectric", 1.5),
        unit("coat_weight", "presence of the coat", 0, {{.low = 0.1, .high = 0.9}}),
        colour("coat_color", "of what passes the coat twice", 1),
        unit("coat_roughness", "square root of the coat's alpha", 0, {{.low = 0.05, .high = 0.8}}),
        unit("coat_roughness_anisotropy", "widens the coat's lobe along x", 0),
        index("coat_ior", "of the coat", 1.6),
        unit("coat_darkening", "share of the reflections inside the coat", 1, {FitRange{}}),
        unit("fuzz_weight", "presence of the fuzz", 0, {{.low = 0.1, .high = 0.9}}),
        linearIf(colour("fuzz_color", "of the fuzz", 1, {{.low = 0.1, .high = 1}}), alwaysLinear),
        unit("fuzz_roughness", "of its fibres", 0.5, {{.low = 0.1, .high = 0.9}})};
}

}  // namespace

const Model& openpbrModel() {
    static const Model model{
        .name = "openpbr",
        .help = "OpenPBR Surface: base, metal, coat and fuzz",
        .source = "OpenPBR Surface 1.1, Academy Software Foundation 2024",
        .parameters = parameters(),
        .laws = claims,
        .make = make,
        .sampling = sampling,
        .parts = {{"specular", "strength of the dielectric's lobe", {"specular_weight"}},
                  {"ior", "index of the dielectric", {"specular_ior"}},
                  {"coat",
                   "clear layer above the base",
                   {"coat_weight", "coat_color", "coat_roughness", "coat_roughness_anisotropy",
                    "coat_ior", "coat_darkening"}},
                  {"fuzz", "fibres above all", {"fuzz_weight", "fuzz_color", "fuzz_roughness"}},
                  {"anisotropy", "lobe wider along x", {"specular_roughness_anisotropy"}}}};
    return model;
}

}  // namespace hshfit::brdfs
