#include <brdfs/analytic/minnaert.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/sampling/axis_lobes.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct MinnaertShape {
    N k;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/minnaert_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalMinnaert);
HWY_EXPORT(minnaertColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = p.number("k") >= 1 || largest(p.colour("kd")) == 0;
    return result;
}

void evalByVectors(const MinnaertShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalMinnaert)(shape, batch);
}

class Minnaert final : public ShapedBrdf<MinnaertShape<double>, evalByVectors,
                                         evalAll<double, MinnaertTerms, MinnaertShape<double>>> {
public:
    explicit Minnaert(const Parameters& p)
        : ShapedBrdf(minnaertModel(), p, lawsOf(p), channelWeights<MinnaertFormula>(p),
                     MinnaertFormula::shape(Values<double>(p, 0))) {}
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Minnaert>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(minnaertColumns)(request);
}

/// Exact: f cos(theta_i) is a power of cos(theta_i).
HasSamplers::Known sampling(const Parameters& p) {
    return {.all = true, .samplers = {powerCosineSampler(normalAxis, p.number("k"))}};
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
        .make = make,
        .columns = columns,
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
