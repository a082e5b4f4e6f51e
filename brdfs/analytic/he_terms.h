// Terms of he.h. Included by he.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// Lambert's W of 0 < x <= 1e300 to 2 %, and far better for small x (Winitzki 2003,
/// 10.1007/3-540-44839-X_82).
template <class T>
HWY_INLINE T lambertWNear(T x) {
    const T l = log1p(x);
    return l - l * log1p(l) / (2.0 + l);
}

/// Lambert's W by the steps of Fritsch, Shafer & Crowley (1973, 10.1145/361952.361970). Each
/// raises the relative error to the fourth power; the first leaves 3e-9.
template <class T>
HWY_INLINE T lambertWOf(T x) {
    const T positive = max(x, T(1e-300));
    T w = lambertWNear(positive);
    for (int step = 0; step < 2; ++step) {
        const T above = 1.0 + w, z = log(positive / w) - w;
        const T q = 2.0 * above * (above + (2. / 3) * z);
        w = w + w * z * (q - z) / (above * (q - 2.0 * z));
    }
    return w;
}

template <int n>
HWY_INLINE Slopes<Lanes, n> erfc(const Slopes<Lanes, n>& a) {
    const Lanes slope = exp(-a.value * a.value) * (-2 * std::numbers::inv_sqrtpi);
    return Slopes<Lanes, n>::chained(erfc(a.value), slope, a);
}

/// W' = 1/((1 + W) exp(W)).
template <int n>
HWY_INLINE Slopes<Lanes, n> lambertWOf(const Slopes<Lanes, n>& x) {
    const Lanes w = lambertWOf(x.value);
    return Slopes<Lanes, n>::chained(w, exp(-w) / (1.0 + w), x);
}

/// (1 + x) log(1 + x) - x for x > -1, without cancellation near 0.
template <class T>
HWY_INLINE T entropy(T x) {
    T sum = 0.0;
    for (int n = 9; n >= 2; --n) sum = T(1.0 / (n * (n - 1))) - sum * x;
    const auto far = abs(x) > T(0.02);
    if (!anyOf(far)) return sum * x * x;
    return select(far, (1.0 + x) * log1p(x) - x, sum * x * x);
}

/// g^m exp(-g) / m! times exp(-b / m) for m > 20, accurate for large g and m: Stirling's
/// series, and g log(m / g) + g - m as a function of (m - g) / g (Loader 2000).
template <class T>
HWY_INLINE T dampedPoisson(T m, T g, T b) {
    const T inverse = 1.0 / m, squared = inverse * inverse;
    const T series = inverse * (1. / 12 - squared * (1. / 360 - squared * (1. / 1260)));
    return exp(-g * entropy((m - g) / g) - series - b * inverse) / sqrt((2 * pi) * m);
}

/// The series of he.h with its derivatives by g and b, where they are asked for.
template <class T>
struct HeSums {
    T sum = 0.0, byG = 0.0, byB = 0.0;
};

/// The series of he.h. Its terms rise to a peak and then fall ever faster, so that a sum ends
/// once a term no longer changes it. All lanes continue until the last has ended.
template <class T, bool slopes = false>
class HeSeries {
public:
    HWY_INLINE HeSeries(T g, T b) : g_(max(g, T(1e-300))), b_(b) {
        // The m of the largest term, to some per cent: the root of log(m / g) = b / m^2, at
        // least 1.
        const T w = lambertWNear(min(2.0 * b_ / g_ / g_, T(1e300)));
        peak_ = max(g_ * exp(0.5 * w), T(1.0));
    }

    HWY_INLINE T sum() const { return sums().sum; }

    HWY_INLINE HeSums<T> sums() const {
        // The terms fall about the peak at least as fast as a Gaussian of standard deviation
        // sqrt(peak), but for the slower upper tail of a Poisson distribution.
        const T longer = peak_ + 9.0 * sqrt(peak_) + 12.0 - static_cast<double>(HeFactors::last);
        const auto many = longer > T(0.0);
        if (!anyOf(many)) return dense(longer);
        if (!anyOf(longer < T(0.0))) return sampled(longer);
        const HeSums<T> a = sampled(longer), b = dense(longer);
        return {select(many, a.sum, b.sum), select(many, a.byG, b.byG), select(many, a.byB, b.byB)};
    }

private:
    static constexpr double negligible = 1e-18;
    static constexpr int mostSamples = 75;

    /// The sum of all terms from m = 1 on, for the lanes with longer < 0.
    HWY_INLINE HeSums<T> dense(T longer) const {
        T factor = exp(-g_), sum = factor * exp(-b_), rise = 0.0, damped = sum;
        for (std::size_t m = 2; m <= HeFactors::last; ++m) {
            factor = factor * (g_ * heFactors.growth[m]);
            const T term = factor * exp(-b_ * heFactors.inverse[m]);
            sum = sum + term;
            if constexpr (slopes) {
                rise = rise + term * static_cast<double>(m - 1);
                damped = damped + term * heFactors.inverse[m];
            }
            const T left = select(peak_ < T(static_cast<double>(m)), term - negligible * sum, 1.0);
            if (!anyOf(select(longer < T(0.0), left, 0.0) > T(0.0))) break;
        }
        return {sum, rise / g_ - sum, -damped};
    }

    /// The sum for the other lanes, from terms a step apart. For a smooth bell of
    /// deviation s both sums are its integral; samples 0.6 s apart err by exp(-2 (pi s /
    /// distance)^2).
    HWY_INLINE HeSums<T> sampled(T longer) const {
        const T curvature = 1.0 / peak_ + 2.0 * b_ / (peak_ * peak_ * peak_);
        const T step = max(T(1.0), truncated(0.6 / sqrt(curvature)));
        const T middle = truncated(peak_ + 0.5);
        T sum = 0.0, rise = 0.0, damped = 0.0;
        const auto add = [&](T m) HWY_ATTR {
            const T term = termAt(m);
            sum = sum + term;
            if constexpr (slopes) {
                rise = rise + term * ((m - 1.0 - g_) / g_);
                damped = damped + term / max(m, T(1.0));
            }
            return term;
        };
        add(middle);
        for (int i = 1; i < mostSamples; ++i) {
            const T above = add(middle + i * step), added = above + add(middle - i * step);
            const T left = added - negligible * sum;
            if (!anyOf(select(longer < T(0.0), 0.0, left) > T(0.0))) break;
        }
        const T scale = step / g_;
        return {sum * scale, rise * scale, -damped * scale};
    }

    HWY_INLINE T termAt(T m) const {
        const T inside = max(m, T(1.0));
        return select(m < T(1.0), T(0.0), dampedPoisson(inside, g_, b_) / inside);
    }

    T g_, b_, peak_;
};

template <class T>
HWY_INLINE T heSum(const T& g, const T& b) {
    return HeSeries<T>(g, b).sum();
}
template <int n>
HWY_INLINE Slopes<Lanes, n> heSum(const Slopes<Lanes, n>& g, const Slopes<Lanes, n>& b) {
    const HeSums<Lanes> sums = HeSeries<Lanes, true>(g.value, b.value).sums();
    Slopes<Lanes, n> result(sums.sum);
    for (int i = 0; i < n; ++i) result.by[i] = sums.byG * g.by[i] + sums.byB * b.by[i];
    return result;
}

/// The quantities of one direction of height z: S / z, and K = tan(theta) erfc(a).
template <class T>
struct Roughened {
    using R = RealOf<T>;
    T visibility, hidden;

    HWY_INLINE Roughened(R z, const T& slope) {
        const R s = sqrt(max(R(0.0), (1.0 - z) * (1.0 + z)));
        const T a = min(z / (slope * s), T(1e150)), tail = erfc(a);
        visibility = (1.0 - 0.5 * tail) / (z + 0.5 * slope * s * ierfc(a));
        hidden = min(s / z, R(1e150)) * tail;
    }
};

template <class T>
class HeTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE HeTerms(const HeShape<N>& shape, const OutgoingOf<T>& wo)
        : shape_(shape), wo_(wo), outgoing_(R(wo.z), T(shape.slope)) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const N& ior = shape_.ior;
        const T height(shape_.height), correlation(shape_.length);
        // The series has to end below the horizon too, although the result is ignored there.
        const Incoming<R> above{wi.x, wi.y, max(wi.z, R(5e-324))};
        const HalfVector<R> h(wo_, above);
        const Roughened<T> incoming(above.z, T(shape_.slope));
        const T shading = (incoming.hidden + outgoing_.hidden) * (1 / std::sqrt(8 * pi));
        // (sigma / sigma0)^2: g = (2 pi height h.z)^2 / (1 + W)
        const T shrunk = 1.0 / (1.0 + lambertWOf(min(shading * shading, T(1e300))));
        const T heights = 2 * pi * height * (above.z + R(wo_.z));
        const T across = pi * correlation * h.scale;
        const R slopes = h.x * h.x + h.y * h.y;
        const T series = heSum(heights * heights * shrunk, across * across * slopes);
        // (pi tau)^2 / 4 (2 pi sigma)^2 / pi: the factor g that the series lacks, over h.z^2.
        const T tall = pi * correlation * height;
        const T scale = tall * tall * pi * shrunk;
        const R length = h.squaredLength() * h.scale * h.scale;
        const T visible = bounded(incoming.visibility * outgoing_.visibility);
        term[0] = reflectanceOf<T>(h.dotOutgoing(), ior, N(0.0)) * length * length *
                  bounded(scale * series * visible);
    }

private:
    HeShape<N> shape_;
    OutgoingOf<T> wo_;
    Roughened<T> outgoing_;
};

struct HeFormula {
    template <class T>
    using Terms = HeTerms<T>;

    template <class N>
    static HeShape<N> shape(const Values<N>& p) {
        const N height = p("sigma") / p("wavelength"), length = p("tau") / p("wavelength");
        return {p("ior"), height, length, 2 * height / length};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("ks")}};
    }
};

void evalHe(const HeShape<double>& shape, const TermBatch& batch) {
    evalLanes<HeTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> heColumns(const ColumnRequest& request) {
    return columnsOf<HeFormula, 3>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
