#include <brdfs/analytic/disney.h>

#include <brdfs/analytic/fresnel.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr Laws claims{.nonNegative = true, .reciprocal = true, .mirrorSymmetric = true};

double mix(double a, double b, double share) {
    return a + (b - a) * share;
}

struct SpecularAxes {
    double ax, ay;

    explicit SpecularAxes(const Parameters& p) {
        const double aspect = std::sqrt(1 - 0.9 * p.number("anisotropic"));
        const double alpha = p.number("roughness") * p.number("roughness");
        ax = std::max(0.001, alpha / aspect);
        ay = std::max(0.001, alpha * aspect);
    }
};

/// Only the metallic lobe alone keeps the energy for certain: F <= 1 and masking that fits Ds.
Laws lawsOf(const Parameters& p) {
    Laws laws = claims;
    laws.isotropic = SpecularAxes(p).ax == SpecularAxes(p).ay;
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

Colour tinted(const Parameters& p, const char* share, double scale) {
    return mapped(tintOf(p.colour("baseColor")),
                  [&](double tint) { return scale * mix(1, tint, p.number(share)); });
}

/// Of: the diffuse part, sheen, 1 - F of the metallic or dielectric lobe, and all that is white.
std::vector<Colour> weightsOf(const Parameters& p) {
    const double metallic = p.number("metallic");
    const Colour base = p.colour("baseColor");
    const Colour c0 = mapped(tinted(p, "specularTint", 0.08 * p.number("specular")), base,
                             [&](double c, double value) { return mix(c, value, metallic); });
    return {mapped(base, [&](double value) { return (1 - metallic) * value / pi; }),
            tinted(p, "sheenTint", (1 - metallic) * p.number("sheen")),
            c0,
            {1.0}};
}

/// Smith's 2 G1/(2 cos) of GGX: 1/(z + sqrt(z^2 + (ax x)^2 + (ay y)^2)).
struct SmithGgx {
    double ax, ay;

    double visible(double x, double y, double z) const {
        return bounded(1 / (z + std::sqrt(z * z + ax * ax * x * x + ay * ay * y * y)));
    }
};

class Disney final : public TermBrdf {
public:
    explicit Disney(const Parameters& p)
        : TermBrdf(disneyModel(), p, lawsOf(p), {0.0}, weightsOf(p)),
          roughness_(p.number("roughness")),
          subsurface_(p.number("subsurface")),
          clearcoat_(0.25 * p.number("clearcoat")),
          gloss_(mix(0.1, 0.001, p.number("clearcoatGloss"))),
          axes_(p) {
        const double old = (0.5 + roughness_ / 2) * (0.5 + roughness_ / 2);
        masking_ =
            p.choice("masking") == "2014" ? SmithGgx{axes_.ax, axes_.ay} : SmithGgx{old, old};
    }

    std::vector<Lobe> lobes(const Direction&) const override {
        std::vector<Lobe> lobes{
            {Lobe::About::halfway, std::min(axes_.ax, axes_.ay), {}, std::max(axes_.ax, axes_.ay)}};
        if (clearcoat_ > 0) lobes.push_back({Lobe::About::halfway, gloss_, {}});
        return lobes;
    }

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        constexpr SmithGgx coat{0.25, 0.25};
        const double masked = masking_.visible(wo.x, wo.y, wo.z);
        const double coatMasked = coat.visible(wo.x, wo.y, wo.z);
        for (std::size_t k = 0; k < wi.count; ++k) {
            const double x = wi.x[k], y = wi.y[k], z = wi.z[k];
            const HalfVector h(wo, x, y, z);
            const double cosine = h.dotOutgoing(), rise = schlickWeight(cosine);
            const double lobe = bounded(density(h) * bounded(masking_.visible(x, y, z) * masked));
            out[k] = diffuse(z, wo.z, cosine);
            out[wi.count + k] = rise;
            out[2 * wi.count + k] = lobe * (1 - rise);
            out[3 * wi.count + k] = lobe * rise;
            if (clearcoat_ > 0)
                out[3 * wi.count + k] += clearcoat_ * schlickReflectance(cosine, 0.04) *
                                         coatDensity(h) *
                                         bounded(coat.visible(x, y, z) * coatMasked);
        }
    }

private:
    double diffuse(double incoming, double outgoing, double cosine) const {
        const double retro = roughness_ * cosine * cosine;
        const auto both = [&](double edge) {
            return mix(1, edge, schlickWeight(incoming)) * mix(1, edge, schlickWeight(outgoing));
        };
        const double flat = 1.25 * (both(retro) * bounded(1 / (incoming + outgoing) - 0.5) + 0.5);
        return mix(both(0.5 + 2 * retro), bounded(flat), subsurface_);
    }

    double density(const HalfVector& h) const {
        const double x = h.x / axes_.ax, y = h.y / axes_.ay;
        const double ratio = h.squaredLength() / (h.z * h.z + x * x + y * y);
        return ratio * ratio / (pi * axes_.ax * axes_.ay);
    }

    double coatDensity(const HalfVector& h) const {
        const double squared = gloss_ * gloss_, slope = h.squaredSlope();
        return (squared - 1) / (pi * std::log(squared)) * (1 + slope) / (squared + slope);
    }

    double roughness_, subsurface_, clearcoat_, gloss_;
    SpecularAxes axes_;
    SmithGgx masking_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Disney>(p);
}

Parameter unitParameter(std::string_view name, std::string_view help, double fallback) {
    return {.name = name, .help = help, .fallback = fallback, .min = 0, .max = 1};
}

Parameter unitParameter(std::string_view name, std::string_view help, double fallback,
                        const FitRange& fit) {
    return fitted(unitParameter(name, help, fallback), {fit});
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
              .fit = {{.low = 0.05, .high = 0.9}}},
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
             // Held at 0, where f is linear in baseColor.
             unitParameter("sheenTint", "of the sheen towards baseColor's hue", 0.5, FitRange{}),
             unitParameter("clearcoat", "strength of a second, white lobe", 0,
                           {.low = 0.1, .high = 0.9}),
             unitParameter("clearcoatGloss", "from satin to gloss", 1, {.low = 0.1, .high = 0.9}),
             {.name = "masking",
              .help = "of the specular lobe, as revised or as first published",
              .kind = Parameter::Kind::choice,
              .choices = {"2014", "2012"}}},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
