#include <brdfs/analytic/abc.h>

#include <brdfs/analytic/kink_curves.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <cmath>

namespace hshfit::brdfs {

template <class N>
struct AbcShape {
    N b, c, ior;
    bool smooth;
};

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/abc_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalAbc);
HWY_EXPORT(abcColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    // The smooth lobe is at most A, so that its albedo is at most pi A.
    const bool limited = p.choice("variant") == "smooth" || largest(p.colour("A")) == 0;
    const Colour albedo =
        mapped(p.colour("kd"), p.colour("A"), [](double kd, double a) { return kd + pi * a; });
    result.energyConserving = limited && largest(albedo) <= 1;
    return result;
}

void evalByVectors(const AbcShape<double>& shape, const TermBatch& batch) {
    HWY_DYNAMIC_DISPATCH(evalAbc)(shape, batch);
}

class Abc final : public ShapedBrdf<AbcShape<double>, evalByVectors,
                                    evalAll<double, AbcTerms, AbcShape<double>>>,
                  public HasKinkCurves {
public:
    explicit Abc(const Parameters& p)
        : ShapedBrdf(abcModel(), p, lawsOf(p), channelWeights<AbcFormula>(p),
                     AbcFormula::shape(Values<double>(p, 0))) {}

    /// Near the mirror direction |D| is the slope times 2 cos(theta_o) and 1 - h.z half its square;
    /// the powers are singular where these reach -1 / B. With a large exponent C they are nearly
    /// Gaussians, with standard deviations below that by sqrt(2 C).
    std::vector<Lobe> lobes(const Direction& wo) const override {
        const double pole = shape_.smooth ? 1 / (2 * std::max(wo.z, 1e-3) * std::sqrt(shape_.b))
                                          : std::sqrt(2 / shape_.b);
        const double width = pole * std::min(1.0, 2.5 / std::sqrt(2 * shape_.c));
        return {{Lobe::About::halfway, std::min(1.0, width), {}}};
    }

    std::vector<double> kinks(const Direction& wo) const override {
        return shape_.smooth ? std::vector<double>{} : std::vector<double>{wo.z};
    }

    std::vector<KinkCurve> kinkCurves(const Direction& wo) const override {
        return shape_.smooth ? std::vector<KinkCurve>{} : vGrooveKinks(wo);
    }
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<Abc>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(abcColumns)(request);
}

}  // namespace

const Model& abcModel() {
    static const Model model{
        .name = "abc",
        .help = "lobe with a power-law tail, of the projected deviation or of facets",
        .source = "Löw, Kronander, Ynnerman & Unger 2012, 10.1145/2077341.2077350",
        .parameters = {kdParameter(0, 1e6),
                       {.name = "A",
                        .help = "height of the lobe before Fresnel's reflectance, 1/sr",
                        .kind = Parameter::Kind::colour,
                        .fallback = 1,
                        .min = 0,
                        .max = 1e8,
                        .fit = {{.low = 0, .high = 1}},
                        .linear = alwaysLinear},
                       {.name = "B",
                        .help = "about 1 / width^2 of the peak",
                        .min = 1e-3,
                        .max = 1e12,
                        .fit = {{.low = 10, .high = 1e7, .logarithmic = true}}},
                       {.name = "C",
                        .help = "exponent of the tail",
                        .min = 0,
                        .max = 1000,
                        .fit = {{.low = 0.1, .high = 4, .logarithmic = true}}},
                       {.name = "ior",
                        .help = "index of refraction of the surface",
                        .fallback = 1.5,
                        .min = 1,
                        .max = 1000,
                        .fit = {{.low = 1.05, .high = 4, .logarithmic = true}}},
                       {.name = "variant",
                        .help = "what the lobe is a function of",
                        .kind = Parameter::Kind::choice,
                        .choices = {"smooth", "microfacet"}}},
        .laws = claims,
        .make = make,
        .columns = columns};
    return model;
}

}  // namespace hshfit::brdfs
