#include <brdfs/analytic/lambert.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <brdfs/analytic/transmission_side.h>

namespace hshfit::brdfs {

struct LambertShape {};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/lambert_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalLambert);
HWY_EXPORT(lambertColumns);

constexpr Laws claims{.nonNegative = true,
                      .reciprocal = true,
                      .isotropic = true,
                      .mirrorSymmetric = true,
                      .energyConserving = true};

/// f is the same in all directions.
class Diffuse : public TermBrdf {
public:
    using TermBrdf::TermBrdf;

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalLambert)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        evalAll<double, LambertTerms>(shape_, batch);
    }

private:
    LambertShape shape_;
};

class Lambert final : public Diffuse {
public:
    explicit Lambert(const Parameters& p)
        : Diffuse(lambertModel(), p, claims, channelWeights<LambertFormula>(p)) {}
};

constexpr Laws transmissionClaims{
    .nonNegative = true, .isotropic = true, .mirrorSymmetric = true, .energyConserving = true};

class LambertTransmission final : public Diffuse {
public:
    explicit LambertTransmission(const Parameters& p)
        : Diffuse(lambertTransmissionModel(), p, transmissionClaims, overPi(p.colour("kt")), {}),
          name_(withSide(Diffuse::name(), p)) {}

    std::string name() const override { return name_; }

private:
    std::string name_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Lambert>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(lambertColumns)(request);
}

HasSamplers::Known sampling(const Parameters&) {
    return {.all = true};
}

}  // namespace

const Model& lambertTransmissionModel() {
    static const Model model{.name = "lambert-transmission",
                             .help = "ideal diffuse transmission",
                             .source = "Lambert 1760, Photometria",
                             .parameters = {{.name = "kt",
                                             .help = "transmittance",
                                             .kind = Parameter::Kind::colour,
                                             .fallback = 1,
                                             .min = 0,
                                             .max = 1,
                                             .fit = {{.low = 0, .high = 1}},
                                             .linear = alwaysLinear},
                                            transmissionSideParameter("side of the light")},
                             .laws = transmissionClaims,
                             .make = [](const Parameters& p) -> std::unique_ptr<Brdf> {
                                 return std::make_unique<LambertTransmission>(p);
                             }};
    return model;
}

const Model& lambertModel() {
    static const Model model{.name = "lambert",
                             .help = "ideal diffuse reflection",
                             .source = "Lambert 1760, Photometria",
                             .parameters = {kdParameter(1, 1)},
                             .laws = claims,
                             .make = make,
                             .columns = columns,
                             .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
