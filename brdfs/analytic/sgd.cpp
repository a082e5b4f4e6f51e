#include <brdfs/analytic/sgd.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::brdfs {

/// The lobe of one channel.
struct ShiftedGamma {
    double alpha, p, lambda, c, k, theta0, f0, f1;
    double peak;  ///< K / pi^2
};

struct SgdShape {
    std::vector<ShiftedGamma> lobes;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/sgd_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalSgd);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// Every parameter that shapes the lobe of a channel.
constexpr std::array shapeNames{"alpha", "p", "K", "Lambda", "c", "k", "theta0", "F0", "F1"};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = largest(p.colour("ks")) == 0 && largest(p.colour("kd")) <= 1;
    return result;
}

std::size_t lobeCount(const Parameters& p) {
    std::size_t count = 1;
    for (const char* name : shapeNames) count = std::max(count, p.colour(name).size());
    return count;
}

/// Gamma(1 - p, alpha), the integral of exp(-u) u^-p from alpha on: Simpson's rule over log u,
/// whose integrand exp((1 - p) v - e^v) has vanished at u = 750. For p to 3 it errs by 1e-9.
double upperGamma(double p, double alpha) {
    constexpr int steps = 2000;
    const double low = std::log(alpha), step = (std::log(750.0) - low) / steps;
    const auto integrand = [&](int i) {
        const double v = low + i * step;
        return std::exp((1 - p) * v - std::exp(v));
    };
    double sum = integrand(0) + integrand(steps);
    for (int i = 1; i < steps; ++i) sum += (i % 2 ? 4 : 2) * integrand(i);
    return sum * step / 3;
}

ShiftedGamma lobeOf(const Parameters& p, std::size_t channel) {
    const auto value = [&](const char* name) {
        const Colour colour = p.colour(name);
        return colour[colour.size() == 1 ? 0 : channel];
    };
    ShiftedGamma lobe{.alpha = value("alpha"),
                      .p = value("p"),
                      .lambda = value("Lambda"),
                      .c = value("c"),
                      .k = value("k"),
                      .theta0 = value("theta0"),
                      .f0 = value("F0"),
                      .f1 = value("F1"),
                      .peak = value("K")};
    if (lobe.peak < 0) lobe.peak = 1 / (lobe.alpha * upperGamma(lobe.p, lobe.alpha));
    lobe.peak /= pi * pi;
    return lobe;
}

class Sgd final : public TermBrdf {
public:
    explicit Sgd(const Parameters& p)
        : TermBrdf(sgdModel(), p, lawsOf(p), overPi(p.colour("kd")),
                   eachInItsChannel(p.colour("ks"), lobeCount(p))) {
        for (std::size_t c = 0; c < lobeCount(p); ++c) shape_.lobes.push_back(lobeOf(p, c));
    }

    /// u^-p is singular at t = i alpha, exp(-u) has a standard deviation of sqrt(alpha / 2).
    std::vector<Lobe> lobes(const Direction&) const override {
        double width = 1;
        for (const ShiftedGamma& lobe : shape_.lobes) width = std::min(width, lobe.alpha);
        return {{Lobe::About::halfway, width, {}}};
    }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalSgd)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::SgdTerms>(shape_, batch);
    }

private:
    SgdShape shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Sgd>(p);
}

Parameter shape(std::string_view name, std::string_view help, std::optional<double> fallback,
                double min, double max, std::vector<FitRange> fit = {}) {
    return {.name = name,
            .help = help,
            .kind = Parameter::Kind::colour,
            .fallback = fallback,
            .min = min,
            .max = max,
            .fit = std::move(fit)};
}

}  // namespace

const Model& sgdModel() {
    static const Model model{
        .name = "sgd",
        .help = "facets of shifted gamma distribution, every parameter per channel",
        .source = "Bagher, Soler & Holzschuch 2012, 10.1111/j.1467-8659.2012.03147.x",
        .parameters = {kdParameter(0, 1e6), ksParameter("scale of the lobe"),
                       shape("alpha", "width and shift of the distribution", {}, 1e-6, 100,
                             {{.low = 1e-4, .high = 0.5, .logarithmic = true}}),
                       shape("p", "steepness of the distribution's tail", 0, 0, 3,
                             {{.low = 0.05, .high = 1.5}}),
                       shape("K", "scale of the distribution; left out, it is normalised", -1, 0,
                             1e12),
                       shape("Lambda", "masking: how deep", 0, 0, 1e12,
                             {{.low = 0.3, .high = 8, .logarithmic = true}}),
                       shape("c", "masking: how fast", 0, 0, 1e200,
                             {{.low = 1e-7, .high = 1, .logarithmic = true}}),
                       shape("k", "masking: exponent", 1, 0, 1e5,
                             {{.low = 5, .high = 60, .logarithmic = true}}),
                       shape("theta0", "masking: angle from which on, in radians", 0, -2, 2,
                             {{.low = -0.4, .high = 0.6}}),
                       shape("F0", "Fresnel reflectance at normal incidence, before F1", 1, -1000,
                             1000, {{.low = 0.02, .high = 1}}),
                       shape("F1", "what is taken off it, times the cosine", 0, -1000, 1000,
                             {{.low = -0.2, .high = 0.2}})},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
