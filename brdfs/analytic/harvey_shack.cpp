#include <brdfs/analytic/harvey_shack.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct HarveyShackShape {
    N l, s;
    bool generalised;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/harvey_shack_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalHarveyShack);
HWY_EXPORT(harveyShackColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// The lobe is at most b0, so that its albedo is at most pi b0.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const Colour albedo =
        mapped(p.colour("kd"), p.colour("b0"), [](double kd, double b) { return kd + pi * b; });
    result.energyConserving = largest(albedo) <= 1;
    return result;
}

void evalByVectors(const HarveyShackShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalHarveyShack)(shape, batch);
}

class HarveyShack final
    : public ShapedBrdf<HarveyShackShape<double>, evalByVectors,
                        evalAll<double, HarveyShackTerms, HarveyShackShape<double>>> {
public:
    explicit HarveyShack(const Parameters& p)
        : ShapedBrdf(harveyShackModel(), p, lawsOf(p), channelWeights<HarveyShackFormula>(p),
                     HarveyShackFormula::shape(Values<double>(p, 0))) {}

    /// As for abc: |D| is the slope times 2 cos(theta_o), and steep tails are nearly Gaussian.
    std::vector<Lobe> lobes(const Direction& wo) const override {
        const double width = shape_.l / (2 * std::max(wo.z, 1e-3)) *
                             std::min(1.0, 2.5 / std::sqrt(std::max(-shape_.s, 1e-6)));
        if (!(width < 1)) return {};
        return {{Lobe::About::halfway, width, {}}};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<HarveyShack>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(harveyShackColumns)(request);
}

}  // namespace

const Model& harveyShackModel() {
    static const Model model{
        .name = "harvey-shack",
        .help = "scatter of polished surfaces by their roughness spectrum, generalised or of 1976",
        .source = "Krywonos, Harvey & Choi 2011, 10.1364/JOSAA.28.001121",
        .parameters = {kdParameter(0, 1e6),
                       {.name = "b0",
                        .help = "height of the lobe at the normal, 1/sr",
                        .kind = Parameter::Kind::colour,
                        .fallback = 1,
                        .min = 0,
                        .max = 1e8,
                        .fit = {{.low = 0, .high = 1}},
                        .linear = alwaysLinear},
                       {.name = "l",
                        .help = "deviation at which the lobe ends, in direction cosines",
                        .min = 1e-5,
                        .max = 1e3,
                        .fit = {{.low = 1e-3, .high = 0.5, .logarithmic = true}}},
                       {.name = "s",
                        .help = "slope of the tail in double-logarithmic plots",
                        .min = -100,
                        .max = 0,
                        .fit = {{.low = -4, .high = -0.5}}},
                       {.name = "variant",
                        .help =
                            "with the obliquity of the generalised theory, or of deviation alone",
                        .kind = Parameter::Kind::choice,
                        .choices = {"generalised", "classic"}}},
        .laws = claims,
        .make = make,
        .columns = columns};
    return model;
}

}  // namespace hshfit::brdfs
