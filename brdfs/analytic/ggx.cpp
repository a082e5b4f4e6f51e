#include <brdfs/analytic/ggx.h>

#include <brdfs/analytic/microfacet.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

class Ggx {
public:
    explicit Ggx(const Roughness& r) : r_(r) {}

    /// |h|^4 / (pi ax ay (z^2 + (x/ax)^2 + (y/ay)^2)^2).
    double density(const HalfVector& h) const {
        const double x = h.x / r_.ax, y = h.y / r_.ay;
        const double ratio = h.squaredLength() / (h.z * h.z + x * x + y * y);
        return ratio * ratio / (pi * r_.ax * r_.ay);
    }

    double scaledLambda(double x, double y, double z) const {
        const double s = r_.ax * r_.ax * x * x + r_.ay * r_.ay * y * y;
        return 0.5 * s / (z + std::sqrt(z * z + s));
    }

    /// D has a pole at the slope i alpha.
    double width() const { return std::min(r_.ax, r_.ay); }
    double spread() const { return std::max(r_.ax, r_.ay); }

private:
    Roughness r_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    const Roughness roughness = roughnessOf(ggxModel(), p);
    return std::make_unique<Microfacet<Ggx>>(ggxModel(), p, microfacetLaws(p, roughness),
                                             Ggx(roughness));
}

}  // namespace

const Model& ggxModel() {
    static const Model model{
        .name = "ggx",
        .help = "GGX (Trowbridge-Reitz) microfacets with Smith masking",
        .source =
            "Walter, Marschner, Li & Torrance 2007, 10.2312/EGWR/EGSR07/195-206; "
            "Heitz 2014, JCGT 3(2)",
        .parameters = microfacetParameters(),
        .laws = microfacetClaims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
