#include <brdfs/analytic/lafortune.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

struct LafortuneShape {
    Direction c;  ///< the diagonal of C
    double exponent;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/lafortune_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalLafortune);

constexpr Laws claims{.nonNegative = true, .reciprocal = true, .mirrorSymmetric = true};

bool normalized(const Parameters& p) {
    return p.choice("normalized") == "true";
}

/// The diagonal of C, its largest component made 1 if normalized.
Direction diagonal(const Parameters& p) {
    const Direction c{p.number("Cx"), p.number("Cy"), p.number("Cz")};
    const double most = std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    if (!normalized(p) || most == 0) return c;
    return {c.x / most, c.y / most, c.z / most};
}

Colour weightOf(const Parameters& p) {
    const double factor = normalized(p) ? (p.number("exponent") + 2) / (2 * pi) : 1;
    return mapped(p.colour("ks"), [&](double ks) { return factor * ks; });
}

/// For |wo| = 1 the lobe is at most (max |C| cos)^exponent about some axis, whose albedo is at most
/// that of a lobe about the normal: ks max |C|^exponent 2 pi / (exponent + 2).
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.isotropic = p.number("Cx") == p.number("Cy");
    const double exponent = p.number("exponent");
    const Direction c = diagonal(p);
    const double reach = std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    const double lobe = atMostLargest(std::pow(reach, exponent)) * 2 * pi / (exponent + 2);
    const Colour albedo = mapped(p.colour("kd"), weightOf(p),
                                 [&](double kd, double weight) { return kd + weight * lobe; });
    result.energyConserving = largest(albedo) <= 1;
    return result;
}

class Lafortune final : public TermBrdf {
public:
    explicit Lafortune(const Parameters& p)
        : TermBrdf(lafortuneModel(), p, lawsOf(p), overPi(p.colour("kd")), {weightOf(p)}),
          shape_{diagonal(p), p.number("exponent")} {}

    std::vector<Lobe> lobes(const Direction& wo) const override {
        const Direction a{shape_.c.x * wo.x, shape_.c.y * wo.y, shape_.c.z * wo.z};
        const double length = std::sqrt(dot(a, a));
        if (!(length > 0)) return {};
        return {{Lobe::About::axis,
                 2.5 / std::sqrt(shape_.exponent + 1),
                 {a.x / length, a.y / length, a.z / length}}};
    }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalLafortune)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::LafortuneTerms>(shape_, batch);
    }

private:
    LafortuneShape shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Lafortune>(p);
}

Parameter weightParameter(std::string_view name, double fallback) {
    return {.name = name,
            .help = "weight of that component's product",
            .fallback = fallback,
            .min = -10,
            .max = 10};
}

}  // namespace

const Model& lafortuneModel() {
    static const Model model{
        .name = "lafortune",
        .help = "one generalised cosine lobe: off-specular, retroreflective, anisotropic",
        .source = "Lafortune, Foo, Torrance & Greenberg 1997, 10.1145/258734.258801",
        .parameters = {kdParameter(0, 1e6), ksParameter("scale of the lobe"),
                       weightParameter("Cx", -1),
                       fitted(weightParameter("Cy", -1),
                              {{.low = -1.5, .high = 1.5, .data = FitRange::Data::anisotropic}}),
                       fitted(weightParameter("Cz", 1), {{.low = 0.3, .high = 1.5}}),
                       exponentParameter("exponent", "of the weighted cosine",
                                         {.low = 1, .high = 1e3}),
                       switchParameter("normalized", "scale the lobe to a largest albedo of ks")},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
