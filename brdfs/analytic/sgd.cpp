#include <brdfs/analytic/sgd.h>

#include <brdfs/analytic/kink_curves.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::brdfs {

/// The lobe of one channel.
template <class N>
struct ShiftedGamma {
    N alpha, p, lambda, c, k, theta0, f0, f1;
    N peak;  ///< K / pi^2
};

template <class N>
struct SgdShape {
    std::vector<ShiftedGamma<N>> lobes;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/sgd_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalSgd);
HWY_EXPORT(sgdColumns);

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

/// The cosines at which F0 + (1 - F0)(1 - cos)^5 - F1 cos is 0: its second derivative has one sign,
/// so that the extremum parts the two.
std::vector<double> fresnelZeros(double f0, double f1) {
    const auto value = [&](double c) { return f0 + (1 - f0) * std::pow(1 - c, 5) - f1 * c; };
    const double power = -f1 / (5 * (1 - f0));  // (1 - cos)^4 at the extremum
    const double extremum = power > 0 ? std::clamp(1 - std::sqrt(std::sqrt(power)), 0.0, 1.0) : 0.0;
    std::vector<double> zeros;
    for (auto [low, high] : {std::pair{0.0, extremum}, {extremum, 1.0}}) {
        if (!(value(low) * value(high) < 0)) continue;
        const bool falls = value(low) > 0;
        constexpr int halvings = 60;
        for (int k = 0; k < halvings; ++k) {
            const double middle = 0.5 * (low + high);
            ((value(middle) > 0) == falls ? low : high) = middle;
        }
        zeros.push_back(low);
    }
    return zeros;
}

class Sgd final : public TermBrdf, public HasKinkCurves {
public:
    explicit Sgd(const Parameters& p)
        : TermBrdf(sgdModel(), p, lawsOf(p), overPi(p.colour("kd")),
                   eachInItsChannel(p.colour("ks"), lobeCount(p))) {
        for (std::size_t c = 0; c < lobeCount(p); ++c)
            shape_.lobes.push_back(SgdFormula::lobe(Values<double>(p, c)));
    }

    /// u^-p is singular at t = i alpha, exp(-u) has a standard deviation of sqrt(alpha / 2).
    std::vector<Lobe> lobes(const Direction&) const override {
        double width = 1;
        for (const ShiftedGamma<double>& lobe : shape_.lobes) width = std::min(width, lobe.alpha);
        return {{Lobe::About::halfway, width, {}}};
    }

    /// The masking of each channel sets in at theta0 and ends where nothing is left.
    std::vector<double> kinks(const Direction&) const override {
        std::vector<double> heights;
        for (const ShiftedGamma<double>& lobe : shape_.lobes) {
            const double span = std::pow(std::log1p(1 / lobe.lambda) / lobe.c, 1 / lobe.k);
            for (const double theta : {lobe.theta0, lobe.theta0 + span})
                if (theta > 0 && theta < pi / 2) heights.push_back(std::cos(theta));
        }
        return heights;
    }

    /// Fresnel's term is cut off at 0.
    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        std::vector<KinkCurve> curves;
        for (const ShiftedGamma<double>& lobe : shape_.lobes)
            for (const double cosine : fresnelZeros(lobe.f0, lobe.f1))
                curves.push_back(halfAngleKink(wo, cosine, true));
        return curves;
    }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalSgd)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        evalAll<double, SgdTerms>(shape_, batch);
    }

private:
    SgdShape<double> shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Sgd>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(sgdColumns)(request);
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
        .make = make,
        .columns = columns};
    return model;
}

}  // namespace hshfit::brdfs
