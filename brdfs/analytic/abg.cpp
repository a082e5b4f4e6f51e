#include <brdfs/analytic/abg.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct AbgShape {
    N b, g;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/abg_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalAbg);
HWY_EXPORT(abgColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

/// The lobe is at most A / B, so that its albedo is at most pi A / B.
Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    const double b = p.number("B");
    const Colour albedo =
        mapped(p.colour("kd"), p.colour("A"), [&](double kd, double a) { return kd + pi * a / b; });
    result.energyConserving = largest(albedo) <= 1;
    return result;
}

void evalByVectors(const AbgShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalAbg)(shape, batch);
}

class Abg final : public ShapedBrdf<AbgShape<double>, evalByVectors,
                                    evalAll<double, AbgTerms, AbgShape<double>>> {
public:
    explicit Abg(const Parameters& p)
        : ShapedBrdf(abgModel(), p, lawsOf(p), channelWeights<AbgFormula>(p),
                     AbgFormula::shape(Values<double>(p, 0))) {}

    /// The lobe has half its height at |D| = B^(1/g); |D| is the slope times 2 cos(theta_o).
    std::vector<Lobe> lobes(const Direction& wo) const override {
        if (!(shape_.g > 0)) return {};
        double width = std::pow(shape_.b, 1 / shape_.g) / (2 * std::max(wo.z, 1e-3));
        // |beta - beta_0|^g is smooth at its tip for even g alone.
        if (std::fmod(shape_.g, 2.0) != 0) width *= 0.05;
        if (!(width < 1)) return {};
        return {{Lobe::About::halfway, std::max(width, 1e-6), {}}};
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Abg>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(abgColumns)(request);
}

}  // namespace

const Model& abgModel() {
    static const Model model{
        .name = "abg",
        .help = "scatter of polished surfaces in optical design programs: A/(B + deviation^g)",
        .source = "Pfisterer 2011, Optics & Photonics News 22 (10), 16-17",
        .parameters = {kdParameter(0, 1e6),
                       {.name = "A",
                        .help = "height of the tail, 1/sr; A/B at the mirror direction",
                        .kind = Parameter::Kind::colour,
                        .fallback = 1,
                        .min = 0,
                        .max = 1e8,
                        .fit = {{.low = 0, .high = 1}},
                        .linear = alwaysLinear},
                       {.name = "B",
                        .help = "where the lobe ends, deviation^g",
                        .min = 1e-12,
                        .max = 1e12,
                        .fit = {{.low = 1e-6, .high = 1, .logarithmic = true}}},
                       {.name = "g",
                        .help = "exponent of the tail",
                        .min = 0,
                        .max = 20,
                        .fit = {{.low = 0.5, .high = 4, .logarithmic = true}}}},
        .laws = claims,
        .make = make,
        .columns = columns};
    return model;
}

}  // namespace hshfit::brdfs
