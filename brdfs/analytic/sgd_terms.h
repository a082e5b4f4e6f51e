// Terms of sgd.h. Included by sgd.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>
#include <brdfs/lanes/lanes_angles.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// D / pi
template <class T, class R, class N>
HWY_INLINE T density(const ShiftedGamma<N>& lobe, R squaredSlope) {
    const T u = T(lobe.alpha) + squaredSlope / T(lobe.alpha);
    const R rise = 1.0 + squaredSlope;
    return bounded(T(lobe.peak) * exp(-u - T(lobe.p) * log(u)) * rise * rise);
}

/// G1 / cos(theta) of a direction of height z and angle theta.
template <class T, class R, class N>
HWY_INLINE T visibility(const ShiftedGamma<N>& lobe, R z, R theta) {
    const T beyond = max(T(0.0), theta - T(lobe.theta0));
    const T fall = expm1(min(T(700.0), bounded(T(lobe.c) * pow(beyond, T(lobe.k)))));
    return min(max(1.0 - T(lobe.lambda) * fall, T(0.0)), T(1.0)) / z;
}

template <class T>
HWY_INLINE T polarAngleOf(const Incoming<T>& w) {
    return PolarAngle<T>(sqrt(w.x * w.x + w.y * w.y), w.z).theta;
}

template <class T>
class SgdTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = someTerms;

    HWY_INLINE SgdTerms(const SgdShape<N>& shape, const OutgoingOf<T>& wo)
        : shape_(shape), wo_(wo) {
        const Incoming<R> outgoing{R(wo.x), R(wo.y), R(wo.z)};
        const R theta = polarAngleOf(outgoing);
        for (std::size_t c = 0; c < shape.lobes.size(); ++c)
            outgoing_[c] = visibility<T>(shape.lobes[c], outgoing.z, theta);
    }

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const HalfVector<R> h(wo_, wi);
        const R squaredSlope = h.squaredSlope(), cosine = h.dotOutgoing();
        const R theta = polarAngleOf(wi);
        for (std::size_t c = 0; c < shape_.lobes.size(); ++c) {
            const ShiftedGamma<N>& lobe = shape_.lobes[c];
            const T visible = bounded(visibility<T>(lobe, wi.z, theta) * outgoing_[c]);
            const T fresnel =
                max(T(0.0), schlickReflectanceOf<T>(cosine, lobe.f0) - T(lobe.f1) * cosine);
            term[c] = fresnel * bounded(density<T>(lobe, squaredSlope) * visible);
        }
    }

private:
    const SgdShape<N>& shape_;
    OutgoingOf<T> wo_;
    T outgoing_[TermBatch::maxTerms];
};

struct SgdFormula {
    template <class T>
    using Terms = SgdTerms<T>;

    template <class N>
    static SgdShape<N> shape(const Values<N>& p) {
        return {{lobe(p)}};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("ks")}};
    }
    template <class N>
    static ShiftedGamma<N> lobe(const Values<N>& p) {
        const N alpha = p("alpha"), tail = p("p"), scale = p("K");
        const N peak = scale < N(0.0) ? 1 / (alpha * upperGamma(tail, alpha)) : scale;
        return {alpha,       tail,    p("Lambda"), p("c"),          p("k"),
                p("theta0"), p("F0"), p("F1"),     peak / (pi * pi)};
    }

private:
    /// Gamma(1 - p, alpha), the integral of exp(-u) u^-p from alpha on: Simpson's rule over v = log
    /// u, where the integrand exp((1 - p) v - e^v) is 0 from u = 750 on. The error is 1e-9 for p up
    /// to 3.
    template <class N>
    static N upperGamma(const N& p, const N& alpha) {
        constexpr int steps = 2000;
        const N low = log(alpha), step = (std::log(750.0) - low) / steps;
        const auto integrand = [&](int i) {
            const N v = low + i * step;
            return exp((1 - p) * v - exp(v));
        };
        N sum = integrand(0) + integrand(steps);
        for (int i = 1; i < steps; ++i) sum = sum + (i % 2 ? 4 : 2) * integrand(i);
        return sum * step / 3;
    }
};

void evalSgd(const SgdShape<double>& shape, const TermBatch& batch) {
    evalLanes<SgdTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> sgdColumns(const ColumnRequest& request) {
    return columnsOf<SgdFormula, 4>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
