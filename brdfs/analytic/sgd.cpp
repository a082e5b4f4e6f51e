#include <brdfs/analytic/sgd.h>

#include <brdfs/analytic/fresnel.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::brdfs {
namespace {

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

/// The lobe of one channel.
class ShiftedGamma {
public:
    ShiftedGamma(const Parameters& p, std::size_t channel) {
        const auto value = [&](const char* name) {
            const Colour colour = p.colour(name);
            return colour[colour.size() == 1 ? 0 : channel];
        };
        alpha_ = value("alpha"), p_ = value("p");
        lambda_ = value("Lambda"), c_ = value("c"), k_ = value("k"), theta0_ = value("theta0");
        f0_ = value("F0"), f1_ = value("F1");
        const double given = value("K");
        const double scale = given < 0 ? 1 / (alpha_ * upperGamma(p_, alpha_)) : given;
        peak_ = scale / (pi * pi);
    }

    double alpha() const { return alpha_; }

    /// D / pi
    double density(double squaredSlope) const {
        const double u = alpha_ + squaredSlope / alpha_;
        const double rise = 1 + squaredSlope;
        return bounded(peak_ * std::exp(-u - p_ * std::log(u)) * rise * rise);
    }

    double fresnel(double cosine) const {
        return std::max(0.0, schlickReflectance(cosine, f0_) - f1_ * cosine);
    }

    /// G1 / cos(theta) of a direction of height z and angle theta.
    double visibility(double z, double theta) const {
        const double beyond = std::max(0.0, theta - theta0_);
        const double fall = std::expm1(std::min(700.0, bounded(c_ * std::pow(beyond, k_))));
        return std::clamp(1 - lambda_ * fall, 0.0, 1.0) / z;
    }

private:
    double alpha_, p_, lambda_, c_, k_, theta0_, f0_, f1_, peak_;
};

class Sgd final : public TermBrdf {
public:
    explicit Sgd(const Parameters& p)
        : TermBrdf(sgdModel(), p, lawsOf(p), overPi(p.colour("kd")),
                   eachInItsChannel(p.colour("ks"), lobeCount(p))) {
        for (std::size_t c = 0; c < lobeCount(p); ++c) lobes_.emplace_back(p, c);
    }

    /// u^-p is singular at t = i alpha, exp(-u) has a standard deviation of sqrt(alpha / 2).
    std::vector<Lobe> lobes(const Direction&) const override {
        double width = 1;
        for (const ShiftedGamma& lobe : lobes_) width = std::min(width, lobe.alpha());
        return {{Lobe::About::halfway, width, {}}};
    }

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        const double thetaO = polarAngle(wo);
        for (std::size_t k = 0; k < wi.count; ++k) {
            const Direction incoming{wi.x[k], wi.y[k], wi.z[k]};
            if (!(incoming.z > 0)) continue;
            const HalfVector h(wo, incoming.x, incoming.y, incoming.z);
            const double squaredSlope = h.squaredSlope(), cosine = h.dotOutgoing();
            const double thetaI = polarAngle(incoming);
            for (std::size_t c = 0; c < lobes_.size(); ++c) {
                const ShiftedGamma& lobe = lobes_[c];
                const double visible =
                    bounded(lobe.visibility(incoming.z, thetaI) * lobe.visibility(wo.z, thetaO));
                out[c * wi.count + k] =
                    lobe.fresnel(cosine) * bounded(lobe.density(squaredSlope) * visible);
            }
        }
    }

private:
    std::vector<ShiftedGamma> lobes_;
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
