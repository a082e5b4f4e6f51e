#include <brdfs/analytic/he.h>

#include <brdfs/analytic/fresnel.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/parameters.h>
#include <brdfs/analytic/term_batch.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hshfit::brdfs {
namespace {

constexpr Laws claims{
    .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};

Laws lawsOf(const Parameters& p) {
    Laws result = claims;
    result.energyConserving = largest(p.colour("ks")) == 0 && largest(p.colour("kd")) <= 1;
    return result;
}

/// (1 + x) log(1 + x) - x for x > -1, without cancellation near 0.
double entropy(double x) {
    if (std::abs(x) > 0.02) return (1 + x) * std::log1p(x) - x;
    double sum = 0;
    for (int n = 9; n >= 2; --n) sum = sum * -x + 1.0 / (n * (n - 1));
    return sum * x * x;
}

/// log(g^m exp(-g) / m!) for m > 20, whose digits do not suffer from g and m being large:
/// Stirling's series, and g log(m / g) + g - m as a function of (m - g) / g (Loader 2000).
double logPoisson(double m, double g) {
    const double inverse = 1 / m, squared = inverse * inverse;
    const double series = inverse * (1. / 12 - squared * (1. / 360 - squared / 1260));
    return -g * entropy((m - g) / g) - series - 0.5 * std::log(2 * pi * m);
}

/// Where the terms are largest: the root of log(m / g) = b / m^2, at least 1. The difference rises
/// with m and is concave, so that Newton's steps from the left never pass the root.
double largestTerm(double g, double b) {
    double m = std::max(g, 1.0);
    for (int step = 0; step < 100; ++step) {
        const double lack = b / (m * m) - std::log(m / g);
        const double next = m + lack * m / (1 + 2 * b / (m * m));
        if (!(next > m * (1 + 1e-3))) break;
        m = next;
    }
    return m;
}

struct HeShape {
    double ior, height, length, slope;
};

/// Of one direction at a time: the number of terms of the series depends on it.
template <class T>
class HeTerms {
public:
    static constexpr std::size_t count = 1;

    HeTerms(const HeShape& shape, const Direction& wo)
        : shape_(shape), wo_(wo), outgoing_(wo.z, shape.slope) {}

    void operator()(const HWY_NAMESPACE::Incoming<T>& wi, T* term) const {
        term[0] = 0;
        if (!(wi.z > 0)) return;
        const auto& [ior, height, correlation, slope] = shape_;
        const HWY_NAMESPACE::HalfVector<T> h(wo_, wi);
        const Roughened incoming(wi.z, slope);
        const double shading = (incoming.hidden + outgoing_.hidden) / std::sqrt(8 * pi);
        // sigma / sigma0, twice: g = height^2 h.z^2 / (1 + W)
        const double shrunk = 1 / (1 + lambertW(std::min(shading * shading, 1e300)));
        const double heights = 2 * pi * height * (wi.z + wo_.z);
        const double across = pi * correlation * h.scale;
        const double series =
            heSeries(heights * heights * shrunk, across * across * (h.x * h.x + h.y * h.y));
        // (pi tau)^2 / 4 (2 pi sigma)^2 / pi: the g that the series lacks, over h.z^2.
        const double scale = std::pow(pi * correlation * height, 2) * pi * shrunk;
        const double length = h.squaredLength() * h.scale * h.scale;
        const double visible = atMostLargest(incoming.visibility * outgoing_.visibility);
        term[0] = dielectricReflectance(h.dotOutgoing(), ior) * length * length *
                  atMostLargest(scale * series * visible);
    }

private:
    /// What depends on one direction of height z: S / z, and K = tan(theta) erfc(a).
    struct Roughened {
        double visibility, hidden;

        Roughened(double z, double slope) {
            const double s = std::sqrt((1 - z) * (1 + z));
            const double a = s > 0 ? z / (slope * s) : 1e300;
            const double tail = std::erfc(a);
            const double scaledLambda =
                0.5 * (slope * s * std::exp(-a * a) * std::numbers::inv_sqrtpi - z * tail);
            visibility = (1 - 0.5 * tail) / (z + std::max(0.0, scaledLambda));
            hidden = s / z > 1e150 ? 1e150 : s / z * tail;
        }
    };

    HeShape shape_;
    Direction wo_;
    Roughened outgoing_;
};

class He final : public TermBrdf {
public:
    explicit He(const Parameters& p)
        : TermBrdf(heModel(), p, lawsOf(p), overPi(p.colour("kd")), {p.colour("ks")}) {
        const double height = p.number("sigma") / p.number("wavelength");
        const double length = p.number("tau") / p.number("wavelength");
        shape_ = {p.number("ior"), height, length, 2 * height / length};
    }

    /// exp(-(pi tau |h.xy|)^2 / m) with m near 1 + g: Gaussian in the slope.
    std::vector<Lobe> lobes(const Direction& wo) const override {
        const double z = 2 * std::max(wo.z, 1e-3), phase = 2 * pi * shape_.height * z;
        const double deviation = std::sqrt(0.5 * (1 + phase * phase)) / (pi * shape_.length * z);
        return {{Lobe::About::halfway, std::min(1.0, 2.5 * deviation), {}}};
    }

protected:
    void evalBatch(const TermBatch& batch) const override { evalBatchScalar(batch); }
    void evalBatchScalar(const TermBatch& batch) const override {
        HWY_NAMESPACE::evalAll<double, HeTerms>(shape_, batch);
    }

private:
    HeShape shape_;
};

std::unique_ptr<Brdf> make(const Parameters& p) {
    return std::make_unique<He>(p);
}

}  // namespace

double lambertW(double x) {
    double w = std::log1p(x);  // above W; Halley's steps from there gain digits threefold
    if (x > 10) w -= std::log(w);
    for (int step = 0; step < 8; ++step) {
        // f / exp(w), so that nothing overflows.
        const double excess = w - x * std::exp(-w);
        const double change = excess / ((w + 1) - (w + 2) * excess / (2 * w + 2));
        w -= change;
        if (std::abs(change) <= 1e-16 * std::abs(w)) break;
    }
    return w;
}

double heSeries(double g, double b) {
    if (!(g > 0)) return std::exp(-b);
    const double peak = largestTerm(g, b);
    // The logarithm of the terms falls at least like that of a Gaussian of this deviation about the
    // peak, more slowly only like a Poisson distribution's.
    const double deviation = std::sqrt(peak);
    constexpr double reach = 9, denseUntil = 150;
    const double last = peak + reach * deviation + 12;
    if (last < denseUntil) {
        double sum = 0, logFactorialOfM = 0;
        for (int m = 1; m <= last; ++m) {
            logFactorialOfM += std::log(static_cast<double>(m));
            sum += std::exp((m - 1) * std::log(g) - g - logFactorialOfM - b / m) / m;
        }
        return sum;
    }
    // So many terms of a smooth bell of the deviation s sum up to its integral, and so do samples
    // of it at a distance of 0.6 s: they err by exp(-2 (pi s / distance)^2).
    const double curvature = 1 / peak + 2 * b / (peak * peak * peak);
    const double width = 1 / std::sqrt(curvature);
    const double step = std::max(1.0, std::floor(0.6 * width)), middle = std::round(peak);
    double sum = 0;
    for (int side : {-1, 1})
        for (int i = side < 0 ? 1 : 0; i * step <= 1.2 * reach * width + 12; ++i) {
            const double m = middle + side * i * step;
            if (m < 1) break;
            sum += std::exp(logPoisson(m, g) - b / m) / m;
        }
    return sum * step / g;
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
        .make = make};
    return model;
}

}  // namespace hshfit::brdfs
