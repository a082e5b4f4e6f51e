#include <brdfs/analytic/sg.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/visible_normals.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct SphericalGaussianShape {
    N sharpness;
    bool aboutNormal;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/sg_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalSphericalGaussian);
HWY_EXPORT(sphericalGaussianColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// cos_i <= 1 and d omega_i <= 4 d omega_h bound the albedo by the integral over the sphere.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const Values<double> values(p, 0);
    const double lobe = SphericalGaussianFormula::scale(values) *
                        (p.choice("axis") == "normal" ? 4 : 1) /
                        SphericalGaussianFormula::sphereFactor(values("sharpness"));
    const Colour bound = mapped(p.colour("kd"), p.colour("ks"),
                                [&](double kd, double ks) { return kd + ks * lobe; });
    result.energyConserving = largest(bound) <= 1;
    return result;
}

void evalByVectors(const SphericalGaussianShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalSphericalGaussian)(shape, batch);
}

class SphericalGaussian final
    : public ShapedBrdf<SphericalGaussianShape<double>, evalByVectors,
                        evalAll<double, SphericalGaussianTerms, SphericalGaussianShape<double>>> {
public:
    explicit SphericalGaussian(const Parameters& p)
        : ShapedBrdf(sgModel(), p, lawsOf(p), channelWeights<SphericalGaussianFormula>(p),
                     SphericalGaussianFormula::shape(Values<double>(p, 0))) {}

    /// Standard deviation 1 / sqrt(lambda), of the angle or of the slope.
    std::vector<Lobe> lobes(const Direction& wo) const override {
        const double width = std::min(1.0, 2.5 / std::sqrt(shape_.sharpness + 1));
        if (shape_.aboutNormal) return {{Lobe::About::halfway, width, {}}};
        return {{Lobe::About::axis, width, mirrored(wo)}};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<SphericalGaussian>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(sphericalGaussianColumns)(request);
}

/// Exact up to cos(theta_i) about the mirror direction; about the normal the power of the same
/// width, cos^lambda = exp(-lambda versine) to first order.
HasSamplers::Known sampling(const Parameters& p) {
    const double sharpness = p.number("sharpness");
    if (p.choice("axis") == "mirror")
        return {.all = true, .samplers = {gaussianLobeSampler(mirrorAxis, sharpness)}};
    return {.all = true, .samplers = {grooveSampler(powerNormals(sharpness + 1, sharpness + 1))}};
}

}  // namespace

const Model& sgModel() {
    static const Model model{
        .name = "sg",
        .help = "spherical Gaussian about the mirror direction, or of the half vector",
        .source = "Wang, Ren, Gong, Snyder & Guo 2009, 10.1145/1618452.1618479",
        .parameters = {kdParameter(0, 1e6),
                       ksParameter("amplitude of the lobe, 1/sr; largest albedo if normalized"),
                       exponentParameter("sharpness", "lambda; 1 / lambda is its variance",
                                         {.low = 1, .high = 1e4}),
                       {.name = "axis",
                        .help = "wi about the mirror direction, or half vector about the normal",
                        .kind = Parameter::Kind::choice,
                        .choices = {"mirror", "normal"}},
                       switchParameter("normalized", "scale the lobe to an albedo of up to ks")},
        .laws = claims,
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
