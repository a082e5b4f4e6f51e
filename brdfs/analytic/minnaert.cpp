#include <brdfs/analytic/minnaert.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>
#include <hshfit/sampling/axis_lobes.h>

#include <cmath>

namespace hshfit::brdfs {

struct MinnaertShape {
    double k;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/minnaert_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

HWY_EXPORT(evalMinnaert);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = p.number("k") >= 1 || largest(p.colour("kd")) == 0;
    return result;
}

void evalByVectors(const MinnaertShape& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalMinnaert)(shape, batch);
}

class Minnaert final
    : public ShapedBrdf<
          MinnaertShape, evalByVectors,
          HWY_NAMESPACE::evalAll<double, HWY_NAMESPACE::MinnaertTerms, MinnaertShape>> {
public:
    explicit Minnaert(const Parameters& p)
        : ShapedBrdf(minnaertModel(), p, lawsOf(p), TermWeights{{0.0}, {overPi(p.colour("kd"))}},
                     MinnaertShape{p.number("k")}) {}
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Minnaert>(p);
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
        .sampling = sampling};
    return model;
}

}  // namespace hshfit::brdfs
