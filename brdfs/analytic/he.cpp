#include <brdfs/analytic/he.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hshfit::brdfs {

template <class N>
struct HeShape {
    N ior, height, length, slope;
};

/// For the factors F_m = g^(m - 1) exp(-g) / (m! m): `growth` is F_m / (g F_{m-1}).
/// `inverse` is 1 / m.
struct HeFactors {
    static constexpr std::size_t last = 150;
    std::array<double, last + 1> growth{}, inverse{};

    constexpr HeFactors() {
        for (std::size_t m = 2; m <= last; ++m) {
            const auto number = static_cast<double>(m);
            growth[m] = (number - 1) / (number * number);
            inverse[m] = 1 / number;
        }
    }
};
constexpr HeFactors heFactors;

}  // namespace hshfit::brdfs

#define HWY_TARGET_INCLUDE "brdfs/analytic/he_terms.h"
#include <brdfs/lanes/each_target.h>

namespace hshfit::brdfs {
namespace {

using namespace HWY_NAMESPACE;

HWY_EXPORT(evalHe);
HWY_EXPORT(heColumns);

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = largest(p.colour("ks")) == 0 && largest(p.colour("kd")) <= 1;
    return result;
}

class He final : public TermBrdf {
public:
    explicit He(const Parameters& p)
        : TermBrdf(heModel(), p, lawsOf(p), channelWeights<HeFormula>(p)),
          shape_(HeFormula::shape(Values<double>(p, 0))) {}

    /// exp(-(pi tau |h.xy|)^2 / m) with m near 1 + g: Gaussian in the slope.
    std::vector<Lobe> lobes(const Direction& wo) const override {
        const double z = 2 * std::max(wo.z, 1e-3), phase = 2 * pi * shape_.height * z;
        const double deviation = std::sqrt(0.5 * (1 + phase * phase)) / (pi * shape_.length * z);
        return {{Lobe::About::halfway, std::min(1.0, 2.5 * deviation), {}}};
    }

protected:
    void evalBatch(const TermBatch& batch) const override {
        HWY_DYNAMIC_DISPATCH(evalHe)(shape_, batch);
    }
    void evalBatchScalar(const TermBatch& batch) const override {
        evalAll<double, HeTerms>(shape_, batch);
    }

private:
    HeShape<double> shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<He>(p);
}

std::unique_ptr<ModelColumns> columns(const ColumnRequest& request) {
    return HWY_DYNAMIC_DISPATCH(heColumns)(request);
}

}  // namespace

double lambertW(double x) {
    return lambertWOf(x);
}

double heSeries(double g, double b) {
    return HeSeries<double>(g, b).sum();
}

const Model& heModel() {
    static const Model model{
        .name = "he",
        .help = "wave optics of a Gaussian rough surface, without the mirror spike",
        .source = "He, Torrance, Sillion & Greenberg 1991, 10.1145/127719.122738, with its errata",
        .parameters = {kdParameter(0, 1e6),
                       ksParameter("scale of the lobe", 1e12),
                       {.name = "sigma",
                        .help = "RMS height of the surface",
                        .min = 1e-6,
                        .max = 1e4,
                        .fit = {{.low = 0.02, .high = 2, .logarithmic = true}}},
                       {.name = "tau",
                        .help = "autocorrelation length of the surface",
                        .min = 1e-3,
                        .max = 1e6,
                        .fit = {{.low = 0.3, .high = 100, .logarithmic = true}}},
                       {.name = "wavelength",
                        .help = "of the light, in the unit of sigma and tau",
                        .fallback = 1,
                        .min = 1e-6,
                        .max = 1e6},
                       {.name = "ior",
                        .help = "index of refraction of the surface",
                        .fallback = 1.5,
                        .min = 1,
                        .max = 1000,
                        .fit = {{.low = 1.05, .high = 4, .logarithmic = true}}}},
        .laws = claims,
        .make = make,
        .columns = columns};
    return model;
}

}  // namespace hshfit::brdfs
