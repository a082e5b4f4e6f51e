#include <brdfs/analytic/lambert.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

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

class Lambert final : public TermBrdf {
public:
    explicit Lambert(const Parameters& p)
        : TermBrdf(lambertModel(), p, claims, channelWeights<LambertFormula>(p)) {}

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
