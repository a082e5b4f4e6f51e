#include <brdfs/analytic/hapke.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>

namespace hshfit::brdfs {

template <class N>
struct HapkeShape {
    N w, b, c, surge, width;
    bool old;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/hapke_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalHapke);
HWY_EXPORT(hapkeColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = p.number("w") == 0 || largest(p.colour("ks")) == 0;
    return result;
}

void evalByVectors(const HapkeShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalHapke)(shape, batch);
}

class Hapke final : public ShapedBrdf<HapkeShape<double>, evalByVectors,
                                      evalAll<double, HapkeTerms, HapkeShape<double>>> {
public:
    explicit Hapke(const Parameters& p)
        : ShapedBrdf(hapkeModel(), p, lawsOf(p), channelWeights<HapkeFormula>(p),
                     HapkeFormula::shape(Values<double>(p, 0))) {}

    /// The surge has half its height at tan(g/2) = h; the phase function is about as wide as 1 - b.
    std::vector<Lobe> lobes(const Direction& wo) const override {
        double width = 1 - shape_.b;
        if (shape_.surge > 0) width = std::min(width, 2 * shape_.width);
        if (!(width < 1)) return {};
        return {{Lobe::About::axis, std::max(width, 1e-4), wo}};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Hapke>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(hapkeColumns)(request);
}

}  // namespace

const Model& hapkeModel() {
    static const Model model{
        .name = "hapke",
        .help = "regolith and powders: multiple scattering, phase function, opposition surge",
        .source = "Hapke 1981, 10.1029/JB086iB04p03039",
        .parameters = {ksParameter("scale of the whole"),
                       {.name = "w",
                        .help = "single-scattering albedo",
                        .min = 0,
                        .max = 1,
                        .fit = {{.low = 0.05, .high = 0.95}}},
                       {.name = "b",
                        .help = "width of the phase function, 0: the same in all directions",
                        .fallback = 0,
                        .min = 0,
                        .max = 0.99,
                        .fit = {{.low = 0.1, .high = 0.7}}},
                       {.name = "c",
                        .help = "direction of the phase function, 1: back, -1: forward",
                        .fallback = 0,
                        .min = -1,
                        .max = 1,
                        .fit = {{.low = -0.8, .high = 0.8}}},
                       {.name = "B0",
                        .help = "height of the opposition surge",
                        .fallback = 0,
                        .min = 0,
                        .max = 10,
                        .fit = {{.low = 0, .high = 1}}},
                       {.name = "h",
                        .help = "half width of the opposition surge, tan(g/2)",
                        .fallback = 0.1,
                        .min = 1e-3,
                        .max = 10,
                        .fit = {{.low = 0.02, .high = 0.5, .logarithmic = true}}},
                       {.name = "h-function",
                        .help = "approximation of the multiple scattering",
                        .kind = Parameter::Kind::choice,
                        .choices = {"1981", "2002"}}},
        .laws = claims,
        .make = make,
        .columns = columns};
    return model;
}

}  // namespace hshfit::brdfs
