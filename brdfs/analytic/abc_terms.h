// Terms of abc.h. Included by abc.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class AbcTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = 1;

    HWY_INLINE AbcTerms(const AbcShape<N>& shape, const OutgoingOf<T>& wo)
        : wo_(wo), b_(shape.b), power_(-shape.c), ior_(shape.ior), smooth_(shape.smooth) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const HalfVector<R> h(wo_, wi);
        const T reflectance = reflectanceOf<T>(h.dotOutgoing(), ior_, N(0.0));
        if (smooth_) {
            const R squared = h.scale * h.scale * (h.x * h.x + h.y * h.y);
            term[0] = reflectance * tail(squared);
        } else {
            const R visible = vGrooveVisibility(h, wi.z, R(wo_.z));
            const T slopes = tail(slopeVersine(h.squaredSlope()));
            term[0] = reflectance * bounded(slopes * visible * (1 / pi));
        }
    }

private:
    /// (1 + B x)^-C
    HWY_INLINE T tail(R x) const { return exp(power_ * log1p(b_ * x)); }

    OutgoingOf<T> wo_;
    T b_, power_;
    N ior_;
    bool smooth_;
};

struct AbcFormula {
    template <class T>
    using Terms = AbcTerms<T>;

    template <class N>
    static AbcShape<N> shape(const Values<N>& p) {
        return {p("B"), p("C"), p("ior"), p.chosen("variant", "smooth")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("A")}};
    }
};

void evalAbc(const AbcShape<double>& shape, const TermBatch& batch) {
    evalLanes<AbcTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> abcColumns(const ColumnRequest& request) {
    return columnsOf<AbcFormula, 3>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
