#include <brdfs/analytic/gtr.h>

#include <brdfs/analytic/microfacet.h>
#include <brdfs/analytic/parameters.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace hshfit::brdfs {

/// Lambda over that of GGX, whose logarithm is tabulated over the logarithm of the cotangent: it is
/// smooth there, and constant beyond both ends.
struct LambdaTable {
    static constexpr double step = 0.04, high = 12;
    double low;
    std::vector<double> values;  ///< at low + k step
};

template <class N>
struct GtrShape {
    N alpha, gamma, peak;
    std::shared_ptr<const LambdaTable> table;

    N widthX() const { return std::min(1.0, alpha); }
    N widthY() const { return widthX(); }
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/gtr_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalGtr);

/// (exp(x) - 1)/x.
double growth(double x) {
    return x == 0 ? 1 : std::expm1(x) / x;
}

/// c alpha^(-2 gamma): D is this times ((1 + t^2)/(1 + (t/alpha)^2))^gamma at the slope t.
double peakOf(double alpha, double gamma) {
    const double logSquare = 2 * std::log(alpha);
    return growth(logSquare) / growth((1 - gamma) * logSquare) / pi * std::pow(alpha, -2 * gamma);
}

/// z Lambda of a direction with slope t = x / z against the normal, at unit length:
///     z Lambda = s integral_{1/t}^inf (q - 1/t) P(q) dq,
/// P the density of slopes along one axis. Over circles of slope, w^2 = slope^2 - 1/t^2,
///     z Lambda = 2 integral_0^inf (s w - z atan(s w/z)) D(slope)/(1 + slope^2)^2 w dw.
/// In log w the integrand is analytic to Im = pi/2, so that the trapezoid rule converges fast.
double scaledLambda(double alpha, double gamma, double peak, double sine, double cosine) {
    const double squaredCotangent = cosine * cosine / (sine * sine);
    const double scale = std::hypot(alpha, cosine / sine);
    constexpr double step = 0.15;
    double sum = 0;
    for (int i = -60; i <= 240; ++i) {
        const double w = scale * std::exp(i * step), squared = w * w + squaredCotangent;
        const double log = std::log1p(squared) - std::log1p(squared / (alpha * alpha));
        const double slopes = std::exp(gamma * log) / ((1 + squared) * (1 + squared));
        const double sw = sine * w;
        // s w - z atan(s w/z), by its series where the two cancel.
        const double ratio = sw / cosine;
        const double excess = ratio < 1e-3 ? sw * ratio * ratio * (1. / 3 - ratio * ratio / 5)
                                           : sw - cosine * std::atan2(sw, cosine);
        sum += slopes * excess * w * w;
    }
    return 2 * peak * sum * step;
}

std::shared_ptr<const LambdaTable> lambdaTable(double alpha, double gamma, double peak) {
    auto table = std::make_shared<LambdaTable>();
    table->low = std::log(alpha) - 16;
    const auto count = std::size_t((LambdaTable::high - table->low) / LambdaTable::step) + 2;
    for (std::size_t k = 0; k < count; ++k) {
        const double cotangent = std::exp(table->low + static_cast<double>(k) * LambdaTable::step);
        const double sine = 1 / std::hypot(1, cotangent), cosine = cotangent * sine;
        const double s = alpha * alpha * sine * sine;
        const double ggx = 0.5 * s / (cosine + std::sqrt(cosine * cosine + s));
        table->values.push_back(std::log(scaledLambda(alpha, gamma, peak, sine, cosine) / ggx));
    }
    return table;
}

GtrShape<double> shapeOf(double alpha, double gamma) {
    const double peak = peakOf(alpha, gamma);
    return {alpha, gamma, peak, lambdaTable(alpha, gamma, peak)};
}

class Gtr final : public Microfacet<GtrShape<double>> {
public:
    using Microfacet::Microfacet;

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalGtr)(shape(), batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::GtrTerms>(shape(), batch);
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    Laws laws = microfacetLaws(p, {1, 1});
    return std::make_unique<Gtr>(gtrModel(), p, laws,
                                 shapeOf(p.number("alpha"), p.number("gamma")));
}

std::vector<Parameter> parameters() {
    std::vector<Parameter> all{kdParameter(0, 1), facetScaleParameter()};
    for (const Parameter& parameter : facetFresnelParameters()) all.push_back(parameter);
    all.push_back({.name = "alpha",
                   .help = "roughness",
                   .min = 1e-4,
                   .max = 1,
                   .fit = {{.low = 3e-3, .high = 0.7, .logarithmic = true}}});
    all.push_back({.name = "gamma",
                   .help = "fall of the tails; 2 is GGX, less has longer ones",
                   .min = 0.1,
                   .max = 10,
                   .fit = {{.low = 1, .high = 4, .logarithmic = true}}});
    all.push_back(maskingParameter());
    return all;
}

}  // namespace

const Model& gtrModel() {
    static const Model model{
        .name = "gtr",
        .help = "generalised Trowbridge-Reitz microfacets with their own Smith masking",
        .source =
            "Burley 2012, Physically-based shading at Disney, SIGGRAPH course notes; "
            "Heitz 2014, JCGT 3(2)",
        .parameters = parameters(),
        .laws = {.nonNegative = true,
                 .reciprocal = true,
                 .isotropic = true,
                 .mirrorSymmetric = true},
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
