#include <brdfs/analytic/rough_glass.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <brdfs/analytic/transmission_side.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/brdf/steps.h>
#include <hshfit/brdf/transmission.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

struct RoughGlassShape {
    double alpha, index;  ///< index: n_o / n_i
    bool beckmann;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/rough_glass_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalRoughGlass);

constexpr Laws claims{.nonNegative = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = largest(p.colour("kt")) <= 1;
    return result;
}

RoughGlassShape shapeOf(const Parameters& p) {
    const double ior = p.number("ior");
    return {.alpha = p.number("alpha"),
            .index = p.choice("side") == "transmission-front" ? ior : 1 / ior,
            .beckmann = p.choice("distribution") == "beckmann"};
}

/// The peak of f over one direction if the other is w: the direction to which a facet that lies in
/// the surface refracts w. n is the index on the side of w over the index on the other side.
std::vector<Lobe> refracted(const Direction& w, double n, const RoughGlassShape& shape) {
    const double sine = n * std::hypot(w.x, w.y);
    // Slopes are half of what they were 2.5 standard deviations from the peak of a Gaussian.
    const double spread = shape.beckmann ? 1.77 * shape.alpha : shape.alpha;
    if (!(sine < 1)) {
        // Beyond the critical angle: facets that lean towards it send light along the surface.
        const double across = std::hypot(w.x, w.y);
        return {{Lobe::About::axis,
                 std::max(spread * n * w.z, 1e-4),
                 {-w.x / across, -w.y / across, 0}}};
    }
    const double z = std::sqrt((1 - sine) * (1 + sine));
    return {{Lobe::About::axis,
             std::clamp(spread * std::abs(n * w.z - z), 1e-5, 1.0),
             {-n * w.x, -n * w.y, z}}};
}

class RoughGlass final : public TermBrdf,
                         public HasKinkCurves,
                         public HasSteps,
                         public HasOutgoingLobes {
public:
    explicit RoughGlass(const Parameters& p)
        : TermBrdf(roughGlassModel(), p, lawsOf(p), Colour{0}, {p.colour("kt")}),
          shape_(shapeOf(p)),
          side_(withSide(TermBrdf::name(), p)) {}

    std::string name() const override { return side_; }
    std::vector<Lobe> lobes(const Direction& wo) const override {
        return refracted(wo, shape_.index, shape_);
    }
    std::vector<Lobe> outgoingLobes(const Direction& wi) const override {
        return refracted(wi, 1 / shape_.index, shape_);
    }
    std::vector<double> kinks(const Direction& wo) const override {
        return upright(shape_.index * wo.z);
    }
    std::vector<double> outgoingKinks(const Direction& wi) const override {
        return upright(wi.z / shape_.index);
    }
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override { return along(wo); }
    std::vector<KinkCurve> outgoingKinkCurves(const Direction& wi) const override {
        return along(wi);
    }
    int squareLevels() const override { return 0; }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalRoughGlass)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::RoughGlassTerms>(shape_, batch);
    }

private:
    /// The height at which facets stand upright: GGX's D ends there.
    static std::vector<double> upright(double height) {
        return height < 1 ? std::vector<double>{height} : std::vector<double>{};
    }
    /// The directions in which light enters or leaves along its facet.
    std::vector<KinkCurve> along(const Direction& w) const {
        const double least = std::min(shape_.index, 1 / shape_.index);
        return {{.x = w.x, .y = w.y, .constant = least, .linear = -w.z}};
    }

    RoughGlassShape shape_;
    std::string side_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<RoughGlass>(p);
}

}  // namespace

const Model& roughGlassModel() {
    static const Model model{
        .name = "rough-glass",
        .help = "transmission through a rough boundary of glass: GGX or Beckmann facets",
        .source = "Walter, Marschner, Li & Torrance 2007, 10.2312/EGWR/EGSR07/195-206",
        .parameters = {{.name = "kt",
                        .help = "factor of the transmission",
                        .kind = Parameter::Kind::colour,
                        .fallback = 1,
                        .min = 0,
                        .max = 1e6,
                        .fit = {{.low = 0, .high = 1}},
                        .linear = alwaysLinear},
                       roughnessParameter("alpha", "roughness"),
                       {.name = "ior",
                        .help = "index of refraction of the glass",
                        .fallback = 1.5,
                        .min = 1.05,
                        .max = 4,
                        .fit = {{.low = 1.2, .high = 2}}},
                       {.name = "distribution",
                        .help = "of the slopes of facets",
                        .kind = Parameter::Kind::choice,
                        .choices = {"ggx", "beckmann"}},
                       transmissionSideParameter(
                           "side of the light: front, from the air; back, from the glass")},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
