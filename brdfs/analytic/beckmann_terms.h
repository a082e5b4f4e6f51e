// Terms of beckmann.h. Included by beckmann.cpp once for each instruction set.

#include <brdfs/analytic/facet_terms.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class BeckmannFacets {
    using R = RealOf<T>;

public:
    explicit HWY_INLINE BeckmannFacets(const BeckmannShape<ParameterOf<T>>& shape)
        : ax_(shape.r.ax), ay_(shape.r.ay), inverseX_(1 / shape.r.ax), inverseY_(1 / shape.r.ay) {
        peak_ = 1 / shape.r.ax * (1 / shape.r.ay) / pi;
    }

    HWY_INLINE T density(const HalfVector<R>& h) const {
        const T x = h.x * inverseX_, y = h.y * inverseY_;
        const R inverse = 1.0 / (h.z * h.z), rise = h.squaredLength() * inverse;
        return exp(-(x * x + y * y) * inverse) * rise * rise * peak_;
    }

    HWY_INLINE T scaledLambda(const Incoming<R>& w) const {
        // The least s keeps w.z / s and its derivative, w.z / s^2, finite along the normal.
        const T x = w.x * ax_, y = w.y * ay_, s = max(sqrt(x * x + y * y), T(1e-140));
        return 0.5 * s * ierfc(w.z / s);
    }

private:
    T ax_, ay_, inverseX_, inverseY_, peak_;
};

template <class T>
using BeckmannTerms = FacetTerms<T, BeckmannFacets, BeckmannShape>;

struct BeckmannFormula {
    template <class T>
    using Terms = BeckmannTerms<T>;

    template <class N>
    static auto shape(const Values<N>& p) {
        return facetShape(p, BeckmannShape<N>{facetRoughness(p)});
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return facetWeights(p);
    }
};

void evalBeckmann(const FacetShape<BeckmannShape<double>>& shape, const TermBatch& batch) {
    evalLanes<BeckmannTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> beckmannColumns(const ColumnRequest& request) {
    return columnsOf<BeckmannFormula, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
