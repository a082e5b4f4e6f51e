// Terms of hapke.h. Included by hapke.cpp once for each instruction set.

#include <brdfs/analytic/phase_angle.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class HapkeTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE HapkeTerms(const HapkeShape<N>& s, const OutgoingOf<T>& wo)
        : wo_(wo),
          w_(s.w),
          gamma_(sqrt(max(N(1.0) - s.w, N(1e-16)))),
          r0_((1.0 - gamma_) / (1.0 + gamma_)),
          surge_(s.surge),
          width_(s.width),
          back_(0.5 * (1.0 + s.c)),
          forward_(0.5 * (1.0 - s.c)),
          b_(s.b),
          old_(s.old),
          outgoing_(multiple(R(wo.z))) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const PhaseAngle<R> g(wo_, wi);
        const R cosine = g.halfCosine;
        const R sine = g.halfSine;
        const T surge = surge_ / (1.0 + (sine / max(cosine, R(1e-150))) / width_);
        // 1 - 2 b cos g + b^2 without cancellation at either end.
        const T backSquared = (1.0 - b_) * (1.0 - b_) + 4.0 * b_ * (sine * sine);
        const T forwardSquared = (1.0 - b_) * (1.0 - b_) + 4.0 * b_ * (cosine * cosine);
        const T phase = (1.0 - b_) * (1.0 + b_) *
                        (back_ / (backSquared * sqrt(backSquared)) +
                         forward_ / (forwardSquared * sqrt(forwardSquared)));
        const T scattered = (1.0 + surge) * phase + multiple(wi.z) * outgoing_ - 1.0;
        term[0] = scattered * w_ * bounded(1.0 / (wi.z + R(wo_.z))) * (1 / (4 * pi));
    }

private:
    HWY_INLINE T multiple(R x) const {
        if (old_) return T(1.0 + 2.0 * x) / (1.0 + 2.0 * gamma_ * x);
        // x ln(1 + 1/x) -> 0 at the horizon.
        const R bent = x * log1p(1.0 / max(x, R(1e-300)));
        return 1.0 / (1.0 - w_ * (r0_ * x + (0.5 * (1.0 - 2.0 * r0_ * x)) * bent));
    }

    OutgoingOf<T> wo_;
    T w_, gamma_, r0_, surge_, width_, back_, forward_, b_;
    bool old_;
    T outgoing_;
};

struct HapkeFormula {
    template <class T>
    using Terms = HapkeTerms<T>;

    template <class N>
    static HapkeShape<N> shape(const Values<N>& p) {
        return {p("w"), p("b"), p("c"), p("B0"), p("h"), p.chosen("h-function", "1981")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {N(0.0), {p("ks")}};
    }
};

void evalHapke(const HapkeShape<double>& shape, const TermBatch& batch) {
    evalLanes<HapkeTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> hapkeColumns(const ColumnRequest& request) {
    return columnsOf<HapkeFormula, 5>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
