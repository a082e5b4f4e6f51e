#include <brdfs/analytic/beckmann.h>

#include <brdfs/analytic/microfacet.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hshfit::brdfs {
namespace {

class Beckmann {
public:
    explicit Beckmann(const Roughness& r) : r_(r) {}

    double density(const HalfVector& h) const {
        const double tx = h.slopeX() / r_.ax, ty = h.slopeY() / r_.ay;
        const double rise = 1 + h.squaredSlope();
        return std::exp(-(tx * tx + ty * ty)) * rise * rise / (pi * r_.ax * r_.ay);
    }

    double scaledLambda(double x, double y, double z) const {
        const double s = std::sqrt(r_.ax * r_.ax * x * x + r_.ay * r_.ay * y * y);
        const double a = z / s;
        return 0.5 * (std::exp(-a * a) * s * std::numbers::inv_sqrtpi - std::erfc(a) * z);
    }

    /// exp(-(t / alpha)^2) has a standard deviation of alpha / sqrt(2).
    double width() const { return 2.5 / std::numbers::sqrt2 * std::min(r_.ax, r_.ay); }
    double spread() const { return 2.5 / std::numbers::sqrt2 * std::max(r_.ax, r_.ay); }

private:
    Roughness r_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    const Roughness roughness = roughnessOf(beckmannModel(), p);
    return std::make_unique<Microfacet<Beckmann>>(beckmannModel(), p, microfacetLaws(p, roughness),
                                                  Beckmann(roughness));
}

}  // namespace

const Model& beckmannModel() {
    static const Model model{
        .name = "beckmann",
        .help = "microfacets of Gaussian slope with Smith masking",
        .source =
            "Walter, Marschner, Li & Torrance 2007, 10.2312/EGWR/EGSR07/195-206; "
            "Heitz 2014, JCGT 3(2)",
        .parameters = microfacetParameters(),
        .laws = microfacetClaims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
