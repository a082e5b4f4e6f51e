#include <brdfs/analytic/rpv.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct RpvShape {
    N k, theta;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/rpv_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalRpv);
HWY_EXPORT(rpvColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// For k >= 1 the bowl is at most 2^(k - 1), for Theta = 0 the phase function 1, and the hot spot
/// at most doubles f.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const double k = p.number("k");
    result.energyConserving =
        largest(p.colour("rho0")) == 0 || (k >= 1 && p.number("Theta") == 0 &&
                                           largest(p.colour("rho0")) * 2 * std::pow(2, k - 1) <= 1);
    return result;
}

void evalByVectors(const RpvShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalRpv)(shape, batch);
}

class Rpv final : public ShapedBrdf<RpvShape<double>, evalByVectors,
                                    evalAll<double, RpvTerms, RpvShape<double>>> {
public:
    explicit Rpv(const Parameters& p)
        : ShapedBrdf(rpvModel(), p, lawsOf(p), channelWeights<RpvFormula>(p),
                     RpvFormula::shape(Values<double>(p, 0))) {}

    /// The hot spot is a cusp at wi = wo.
    std::vector<Lobe> lobes(const Direction& wo) const override {
        // A cone, whose tip is not smooth.
        return {{Lobe::About::axis, 0.01, wo}};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Rpv>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(rpvColumns)(request);
}

}  // namespace

const Model& rpvModel() {
    static const Model model{
        .name = "rpv",
        .help = "land surfaces: bowl, phase function and hot spot of Rahman, Pinty and Verstraete",
        .source = "Rahman, Pinty & Verstraete 1993, 10.1029/93JD02072",
        .parameters = {{.name = "rho0",
                        .help = "intensity of the reflectance factor",
                        .kind = Parameter::Kind::colour,
                        .fallback = 1,
                        .min = 0,
                        .max = 1e6,
                        .fit = {{.low = 0.01, .high = 0.9}},
                        .linear = [](const Parameters& stated) { return stated.given("rhoc"); }},
                       {.name = "k",
                        .help = "bowl below 1, bell above",
                        .min = 0,
                        .max = 10,
                        .fit = {{.low = 0.5, .high = 1.2}}},
                       {.name = "Theta",
                        .help = "asymmetry of the phase function, back below 0",
                        .fallback = 0,
                        .min = -0.99,
                        .max = 0.99,
                        .fit = {{.low = -0.5, .high = 0.5}}},
                       {.name = "rhoc",
                        .help = "strength of the hot spot, 1 is none; left out, rho0",
                        .kind = Parameter::Kind::colour,
                        .fallback = -1,
                        .min = 0,
                        .max = 1}},
        .laws = claims,
        .make = make,
        .columns = columns};
    return model;
}

}  // namespace hshfit::brdfs
