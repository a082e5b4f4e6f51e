#include <brdfs/analytic/lafortune.h>

#include <brdfs/analytic/kink_curves.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/sampling/axis_lobes.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct LafortuneShape {
    N x, y, z;  ///< the diagonal of C
    N exponent;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/lafortune_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalLafortune);
HWY_EXPORT(lafortuneColumns);

constexpr Laws claims{.nonNegative = true, .reciprocal = true, .mirrorSymmetric = true};

/// For |wo| = 1 the lobe is at most (max |C| cos)^exponent about some axis. The albedo is largest
/// if the axis is the normal: ks max |C|^exponent 2 pi / (exponent + 2).
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.isotropic = p.number("Cx") == p.number("Cy");
    const double exponent = p.number("exponent");
    const LafortuneShape<double> c = LafortuneFormula::shape(Values<double>(p, 0));
    const double reach = std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    const double lobe = atMostLargest(std::pow(reach, exponent)) * 2 * pi / (exponent + 2);
    const Colour albedo = mapped(p.colour("kd"), channelWeights<LafortuneFormula>(p).terms[0],
                                 [&](double kd, double weight) { return kd + weight * lobe; });
    result.energyConserving = largest(albedo) <= 1;
    return result;
}

void evalByVectors(const LafortuneShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalLafortune)(shape, batch);
}

class Lafortune final : public ShapedBrdf<LafortuneShape<double>, evalByVectors,
                                          evalAll<double, LafortuneTerms, LafortuneShape<double>>>,
                        public HasKinkCurves {
public:
    explicit Lafortune(const Parameters& p)
        : ShapedBrdf(lafortuneModel(), p, lawsOf(p), channelWeights<LafortuneFormula>(p),
                     LafortuneFormula::shape(Values<double>(p, 0))) {}

    std::vector<Lobe> lobes(const Direction& wo) const override {
        const Direction a{shape_.x * wo.x, shape_.y * wo.y, shape_.z * wo.z};
        const double length = std::sqrt(dot(a, a));
        if (!(length > 0)) return {};
        return {{Lobe::About::axis,
                 2.5 / std::sqrt(shape_.exponent + 1),
                 {a.x / length, a.y / length, a.z / length}}};
    }

    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return clampedPowerKinks({shape_.x * wo.x, shape_.y * wo.y, shape_.z * wo.z},
                                 shape_.exponent);
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Lafortune>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(lafortuneColumns)(request);
}

Parameter weightParameter(std::string_view name, double fallback) {
    return {.name = name,
            .help = "weight of that component's product",
            .fallback = fallback,
            .min = -10,
            .max = 10};
}

/// Exact up to cos(theta_i): (a . wi)^exponent about the axis a = C wo.
HasSamplers::Known sampling(const Parameters& p) {
    const LobeAxis axis{p.number("Cx"), p.number("Cy"), p.number("Cz")};
    return {.all = true, .samplers = {powerCosineSampler(axis, p.number("exponent"))}};
}

}  // namespace

const Model& lafortuneModel() {
    static const Model model{
        .name = "lafortune",
        .help = "one generalised cosine lobe: off-specular, retroreflective, anisotropic",
        .source = "Lafortune, Foo, Torrance & Greenberg 1997, 10.1145/258734.258801",
        .parameters = {kdParameter(0, 1e6),
                       ksParameter("scale of the lobe, 1/sr; an albedo if normalized"),
                       weightParameter("Cx", -1),
                       fitted(weightParameter("Cy", -1),
                              {{.low = -1.5, .high = 1.5, .data = FitRange::Data::anisotropic}}),
                       fitted(weightParameter("Cz", 1), {{.low = 0.3, .high = 1.5}}),
                       exponentParameter("exponent", "of the weighted cosine",
                                         {.low = 1, .high = 1e3}),
                       switchParameter("normalized", "scale the lobe to a largest albedo of ks")},
        .laws = claims,
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
