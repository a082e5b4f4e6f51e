#include <brdfs/analytic/lambert.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

namespace hshfit::brdfs {
namespace {

constexpr Laws claims{.nonNegative = true,
                      .reciprocal = true,
                      .isotropic = true,
                      .mirrorSymmetric = true,
                      .energyConserving = true};

class Lambert final : public TermBrdf {
public:
    explicit Lambert(const Parameters& p)
        : TermBrdf(lambertModel(), p, claims, overPi(p.colour("kd")), {}) {}

protected:
    void terms(const Direction&, DirectionBatch, double*) const override {}
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Lambert>(p);
}

}  // namespace

const Model& lambertModel() {
    static const Model model{.name = "lambert",
                             .help = "ideal diffuse reflection",
                             .source = "Lambert 1760, Photometria",
                             .parameters = {kdParameter(1, 1)},
                             .laws = claims,
                             .make = make};
    return model;
}

}  // namespace hshfit::brdfs
