#include <brdfs/analytic/oren_nayar.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// The coefficients that depend on sigma alone.
struct SigmaTerms {
    double direct, sameSide, across, interreflected;

    explicit SigmaTerms(const Parameters& p) {
        const double sigma = radians(p.number("sigma")), s = sigma * sigma;
        direct = 1 - 0.5 * s / (s + 0.33);
        sameSide = 0.45 * s / (s + 0.09);
        across = 0.125 * s / (s + 0.09);
        interreflected = 0.17 * s / (s + 0.13);
    }
};

/// simplified: the integral of cos_i max(0, cos D) sin alpha tan beta is at most pi / 2.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const SigmaTerms r(p);
    const bool interreflects = p.choice("variant") == "full" && p.number("sigma") > 0;
    result.energyConserving =
        !interreflects && largest(p.colour("kd")) * (r.direct + r.sameSide / 2) <= 1;
    return result;
}

class Simplified final : public TermBrdf {
public:
    explicit Simplified(const Parameters& p)
        : TermBrdf(
              orenNayarModel(), p, lawsOf(p),
              mapped(p.colour("kd"), [&](double kd) { return kd / pi * SigmaTerms(p).direct; }),
              {mapped(p.colour("kd"),
                      [&](double kd) { return kd / pi * SigmaTerms(p).sameSide; })}) {}

    /// The larger and the smaller of the two polar angles change places.
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k)
            out[k] = std::max(0.0, wi.x[k] * wo.x + wi.y[k] * wo.y) / std::max(wi.z[k], wo.z);
    }
};

/// Polar angle, its complement (exact at the horizon) and the azimuth as a unit vector.
struct Polar {
    double sine, cosine, theta, complement, azimuthX, azimuthY;

    Polar(double x, double y, double z) : sine(std::hypot(x, y)), cosine(z) {
        theta = std::atan2(sine, z);
        complement = std::atan2(z, sine);
        azimuthX = sine > 0 ? x / sine : 1;
        azimuthY = sine > 0 ? y / sine : 0;
    }
};

class Full final : public TermBrdf {
public:
    explicit Full(const Parameters& p)
        : TermBrdf(orenNayarModel(), p, lawsOf(p), {0.0},
                   {overPi(p.colour("kd")),
                    mapped(p.colour("kd"), [](double kd) { return kd * kd / pi; })}),
          r_(p) {}

    /// As for the simplified form.
    std::vector<double> kinks(const Direction& wo) const override { return {wo.z}; }

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        const Polar o(wo.x, wo.y, wo.z);
        for (std::size_t k = 0; k < wi.count; ++k) {
            const Polar i(wi.x[k], wi.y[k], wi.z[k]);
            const double cosine =
                std::clamp(i.azimuthX * o.azimuthX + i.azimuthY * o.azimuthY, -1.0, 1.0);
            const bool outgoingLower = o.cosine < i.cosine;
            const Polar& alpha = outgoingLower ? o : i;
            const Polar& beta = outgoingLower ? i : o;
            const double bend = 4 * alpha.theta * beta.theta / (pi * pi);
            const double tilt = 2 * beta.theta / pi;
            const double halfwaySlope =
                bounded(1 / std::tan((alpha.complement + beta.complement) / 2));
            out[k] = r_.direct + r_.sameSide * cosine * bounded(slopeTerm(alpha, beta, cosine)) +
                     r_.across * bend * bend * (1 - std::abs(cosine)) * halfwaySlope;
            out[wi.count + k] = r_.interreflected * (1 - cosine * tilt * tilt);
        }
    }

private:
    /// (sin alpha - [cos D < 0] (2 beta/pi)^3) tan beta; the difference is taken between the
    /// distances of both from 1, which tan beta would otherwise blow up at the horizon.
    static double slopeTerm(const Polar& alpha, const Polar& beta, double cosine) {
        if (cosine >= 0) return alpha.sine * beta.sine / beta.cosine;
        const double e = 2 * beta.complement / pi;
        const double cubeBelowOne = e * (3 - 3 * e + e * e);
        const double sineBelowOne = alpha.cosine / (1 + alpha.sine) * alpha.cosine;
        return (cubeBelowOne - sineBelowOne) / beta.cosine * beta.sine;
    }

    SigmaTerms r_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    if (p.choice("variant") == "full") return std::make_unique<Full>(p);
    return std::make_unique<Simplified>(p);
}

}  // namespace

const Model& orenNayarModel() {
    static const Model model{
        .name = "oren-nayar",
        .help = "rough diffuse surface; simplified, or full with interreflection",
        .source = "Oren & Nayar 1994, 10.1145/192161.192213",
        .parameters = {kdParameter(1, 1),
                       {.name = "sigma",
                        .help = "standard deviation of the groove angle, degrees",
                        .min = 0,
                        .max = 90,
                        .fit = {{.low = 5, .high = 60}}},
                       {.name = "variant",
                        .help = "Eq. 30 or Eq. 29 of the paper",
                        .kind = Parameter::Kind::choice,
                        .choices = {"simplified", "full"}}},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
