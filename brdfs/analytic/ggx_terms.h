// Terms of ggx.h. Included by ggx.cpp once for each instruction set.

#include <brdfs/analytic/facet_terms.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class GgxFacets {
    using R = RealOf<T>;

public:
    explicit HWY_INLINE GgxFacets(const GgxShape<ParameterOf<T>>& shape)
        : ax_(shape.r.ax), ay_(shape.r.ay), inverseX_(1 / shape.r.ax), inverseY_(1 / shape.r.ay) {
        peak_ = 1 / shape.r.ax * (1 / shape.r.ay) / pi;
    }

    /// |h|^4 / (pi ax ay (z^2 + (x/ax)^2 + (y/ay)^2)^2).
    HWY_INLINE T density(const HalfVector<R>& h) const {
        const T x = h.x * inverseX_, y = h.y * inverseY_;
        const T ratio = h.squaredLength() / (h.z * h.z + x * x + y * y);
        return ratio * ratio * peak_;
    }

    HWY_INLINE T scaledLambda(const Incoming<R>& w) const {
        const T x = w.x * ax_, y = w.y * ay_, s = x * x + y * y;
        return 0.5 * s / (w.z + sqrt(w.z * w.z + s));
    }

private:
    T ax_, ay_, inverseX_, inverseY_, peak_;
};

template <class T>
using GgxTerms = FacetTerms<T, GgxFacets, GgxShape>;

struct GgxFormula {
    template <class T>
    using Terms = GgxTerms<T>;

    template <class N>
    static auto shape(const Values<N>& p) {
        return facetShape(p, GgxShape<N>{facetRoughness(p)});
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return facetWeights(p);
    }
};

void evalGgx(const FacetShape<GgxShape<double>>& shape, const TermBatch& batch) {
    evalLanes<GgxTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> ggxColumns(const ColumnRequest& request) {
    return columnsOf<GgxFormula, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
