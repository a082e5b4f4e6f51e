#include <brdfs/analytic/minnaert.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <cmath>

namespace hshfit::brdfs {
namespace {

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = p.number("k") >= 1 || largest(p.colour("kd")) == 0;
    return result;
}

class Minnaert final : public TermBrdf {
public:
    explicit Minnaert(const Parameters& p)
        : TermBrdf(minnaertModel(), p, lawsOf(p), {0.0}, {overPi(p.colour("kd"))}),
          exponent_(p.number("k") - 1),
          scale_((p.number("k") + 1) / 2) {}

protected:
    void terms(const Direction& wo, DirectionBatch wi, double* out) const override {
        const double outgoing = bounded(scale_ * std::pow(wo.z, exponent_));
        for (std::size_t k = 0; k < wi.count; ++k)
            out[k] = outgoing * bounded(std::pow(wi.z[k], exponent_));
    }

private:
    double exponent_, scale_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Minnaert>(p);
}

}  // namespace

const Model& minnaertModel() {
    static const Model model{
        .name = "minnaert",
        .help = "power of both cosines: limb darkening of moons and velvet",
        .source = "Minnaert 1941, 10.1086/144279",
        .parameters = {kdParameter(1, 1),
                       {.name = "k",
                        .help = "limb darkening; 1 is Lambert, less brightens the limb",
                        .min = 0,
                        .max = 100,
                        .fit = {{.low = 0.1, .high = 3}}}},
        .laws = claims,
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
