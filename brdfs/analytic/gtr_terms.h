// Terms of gtr.h. Included by gtr.cpp once for each instruction set.

#include <brdfs/analytic/facet_terms.h>
#include <brdfs/analytic/table_nodes.h>
#include <brdfs/lanes/lanes_angles.h>

#include <array>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// (exp(x) - 1)/x.
HWY_INLINE double growth(double x) {
    return x == 0 ? 1 : std::expm1(x) / x;
}
template <int n>
HWY_INLINE Slopes<double, n> growth(const Slopes<double, n>& a) {
    const double x = a.value, value = growth(x);
    const double slope =
        std::abs(x) < 1e-3 ? 0.5 + x * (1. / 3 + x / 8) : (std::exp(x) - value) / x;
    return Slopes<double, n>::chained(value, slope, a);
}

HWY_INLINE double hypotenuse(double a, double b) {
    return std::hypot(a, b);
}
template <int n>
HWY_INLINE Slopes<Lanes, n> hypotenuse(const Slopes<Lanes, n>& a, const Slopes<Lanes, n>& b) {
    return sqrt(a * a + b * b);
}

/// The angle whose sine and cosine are proportional to these positive numbers.
HWY_INLINE double angleOf(double sine, double cosine) {
    return std::atan2(sine, cosine);
}
template <int n>
HWY_INLINE Slopes<Lanes, n> angleOf(const Slopes<Lanes, n>& sine, const Slopes<Lanes, n>& cosine) {
    const Lanes s = sine.value, c = cosine.value, inverse = 1.0 / (s * s + c * c);
    Slopes<Lanes, n> angle(PolarAngle<Lanes>(s, c).theta);
    for (int i = 0; i < n; ++i) angle.by[i] = (c * sine.by[i] - s * cosine.by[i]) * inverse;
    return angle;
}

/// c alpha^(-2 gamma): D is this times ((1 + t^2)/(1 + (t/alpha)^2))^gamma at the slope t.
template <class N>
N gtrPeak(const N& alpha, const N& gamma) {
    const N logSquare = 2 * log(alpha);
    return growth(logSquare) / growth((1 - gamma) * logSquare) / pi * pow(alpha, -2 * gamma);
}

/// z Lambda of a direction with slope t = x / z against the normal, at unit length:
///     z Lambda = s integral_{1/t}^inf (q - 1/t) P(q) dq,
/// P the density of slopes along one axis. Over circles of slope, w^2 = slope^2 - 1/t^2,
///     z Lambda = 2 integral_0^inf (s w - z atan(s w/z)) D(slope)/(1 + slope^2)^2 w dw.
/// In log w the integrand is analytic to Im = pi/2, so that the trapezoid rule converges fast;
/// where w exceeds 1 and the cotangent by e^14, terms fall by e^-step each.
template <class X>
HWY_INLINE X integratedLambda(const X& alpha, const X& gamma, const X& peak, const X& sine,
                              const X& cosine, double logAlpha) {
    const X squaredCotangent = cosine * cosine / (sine * sine);
    const X scale = hypotenuse(alpha, cosine / sine);
    constexpr double step = 0.25, low = -9, high = 14;
    const int count = static_cast<int>((high - std::min(logAlpha, 0.0) - low) / step) + 1;
    X sum = 0.0, term = 0.0;
    for (int i = 0; i <= count; ++i) {
        const X w = scale * std::exp(low + i * step), squared = w * w + squaredCotangent;
        const X rise = log1p(squared) - log1p(squared / (alpha * alpha));
        const X slopes = exp(gamma * rise) / ((1.0 + squared) * (1.0 + squared));
        const X sw = sine * w;
        // s w - z atan(s w/z), by its series where the two cancel.
        const X ratio = sw / cosine;
        const X excess =
            select(ratio < X(1e-3), sw * ratio * ratio * (1. / 3 - ratio * ratio / 5.0),
                   sw - cosine * angleOf(sw, cosine));
        term = slopes * excess * w * w;
        sum = sum + term;
    }
    return 2.0 * peak * (sum + term / std::expm1(step)) * step;
}

/// Weights of the nodes -5 to 6 for the polynomial through them at `at`, from 0 to 1.
HWY_INLINE std::array<double, 12> nodeWeights(double at) {
    std::array<double, 12> weights{};
    for (int j = 0; j < 12; ++j) {
        weights[j] = 1;
        for (int i = 0; i < 12; ++i)
            if (i != j) weights[j] *= (at + 5 - i) / (j - i);
    }
    return weights;
}

/// By quadrature at every fourth node, with `points` of which the rest is interpolated: to 3e-8 of
/// the logarithm, which is analytic to Im = pi/2 as well.
template <class N>
HWY_ATTR std::shared_ptr<const LambdaTable<N>> lambdaTable(const N& alpha, const N& gamma,
                                                           const N& peak) {
    using X = typename Node<N>::Number;
    using Value = typename Node<N>::Value;
    constexpr std::size_t stride = 4, points = 12;
    auto table = std::make_shared<LambdaTable<N>>();
    const double logAlpha = std::log(plain(alpha));
    table->low = log(alpha) - 16;
    constexpr double step = LambdaTable<N>::step, high = LambdaTable<N>::high;
    table->values.resize(std::size_t((high - plain(table->low)) / step) + 2);
    std::vector<N> nodes((table->values.size() - 1) / stride + points);
    for (std::size_t k = 0; k < nodes.size(); k += lanesIn<Value>()) {
        double numbers[HWY_MAX_BYTES / sizeof(double)];
        for (std::size_t i = 0; i < lanesIn<Value>(); ++i)
            numbers[i] = static_cast<double>(stride) * (static_cast<double>(k + i) - 5);
        Value number;
        load(numbers, number);
        const X a(alpha), cotangent = exp(X(table->low) + number * step);
        const X sine = 1.0 / hypotenuse(X(1.0), cotangent), cosine = cotangent * sine;
        const X s = a * a * sine * sine;
        const X ggx = 0.5 * s / (cosine + sqrt(cosine * cosine + s));
        const X own = integratedLambda(a, X(gamma), X(peak), sine, cosine, logAlpha);
        storeNode(log(own / ggx), std::min(lanesIn<Value>(), nodes.size() - k), &nodes[k]);
    }
    for (std::size_t phase = 0; phase < stride; ++phase) {
        const std::array<double, points> weights = nodeWeights(static_cast<double>(phase) / stride);
        for (std::size_t k = phase; k < table->values.size(); k += stride) {
            N sum = 0.0;
            for (std::size_t j = 0; j < points; ++j) sum = sum + weights[j] * nodes[k / stride + j];
            table->values[k] = sum;
        }
    }
    return table;
}

template <class T>
class GtrFacets {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    explicit HWY_INLINE GtrFacets(const GtrShape<N>& shape)
        : squaredAlpha_(shape.alpha * shape.alpha),
          gamma_(shape.gamma),
          peak_(shape.peak),
          low_(shape.table->low),
          table_(shape.table->values) {}

    HWY_INLINE T density(const HalfVector<R>& h) const {
        const R slope = h.squaredSlope();
        return peak_ * exp(gamma_ * log((1.0 + slope) / (1.0 + slope / squaredAlpha_)));
    }

    HWY_INLINE T scaledLambda(const Incoming<R>& w) const {
        const R squaredSine = w.x * w.x + w.y * w.y;
        const T s = squaredAlpha_ * squaredSine;
        const T ggx = 0.5 * s / (w.z + sqrt(w.z * w.z + s));
        return ggx * ratio(log(w.z / sqrt(squaredSine)));
    }

private:
    /// Cubic through the four nearest nodes.
    HWY_INLINE T ratio(R logCotangent) const {
        const double last = static_cast<double>(table_.size() - 1);
        const T at = min(max((logCotangent - low_) / LambdaTable<N>::step, T(0.0)), T(last));
        const R left = min(max(truncated(plain(at)), R(1.0)), R(last - 2)) - R(1.0);
        const N* v = table_.data();
        const T u = at - left - 1.0, a = u + 1.0, b = u - 1.0, c = u - 2.0;
        return exp(-u * b * c * (1. / 6) * gather(v, left) + a * b * c * 0.5 * gather(v + 1, left) -
                   a * u * c * 0.5 * gather(v + 2, left) +
                   a * u * b * (1. / 6) * gather(v + 3, left));
    }

    T squaredAlpha_, gamma_, peak_, low_;
    const std::vector<N>& table_;
};

template <class T>
using GtrTerms = FacetTerms<T, GtrFacets, GtrShape>;

struct GtrFormula {
    template <class T>
    using Terms = GtrTerms<T>;

    template <class N>
    static auto shape(const Values<N>& p) {
        return facetShape(p, distribution(p));
    }
    template <class N>
    static GtrShape<N> distribution(const Values<N>& p) {
        const N alpha = p("alpha"), gamma = p("gamma"), peak = gtrPeak(alpha, gamma);
        return {alpha, gamma, peak, lambdaTable(alpha, gamma, peak)};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return facetWeights(p);
    }
};

void evalGtr(const FacetShape<GtrShape<double>>& shape, const TermBatch& batch) {
    evalLanes<GtrTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> gtrColumns(const ColumnRequest& request) {
    // A pass tabulates its masking: one for all shapes.
    if (request.shapes.size() > 3) return columnsOf<GtrFormula, 4>(request);
    return columnsOf<GtrFormula, 3>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
