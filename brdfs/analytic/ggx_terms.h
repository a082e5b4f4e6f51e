// Terms of ggx.h. Included by ggx.cpp once for each instruction set.

#include <brdfs/analytic/facet_terms.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class GgxFacets {
public:
    explicit HWY_INLINE GgxFacets(const GgxShape& shape)
        : ax_(shape.r.ax), ay_(shape.r.ay), inverseX_(1 / ax_), inverseY_(1 / ay_) {
        peak_ = inverseX_ * inverseY_ / pi;
    }

    /// |h|^4 / (pi ax ay (z^2 + (x/ax)^2 + (y/ay)^2)^2).
    HWY_INLINE T density(const HalfVector<T>& h) const {
        const T x = h.x * inverseX_, y = h.y * inverseY_;
        const T ratio = h.squaredLength() / (h.z * h.z + x * x + y * y);
        return ratio * ratio * peak_;
    }

    HWY_INLINE T scaledLambda(const Incoming<T>& w) const {
        const T x = w.x * ax_, y = w.y * ay_, s = x * x + y * y;
        return 0.5 * s / (w.z + sqrt(w.z * w.z + s));
    }

private:
    double ax_, ay_, inverseX_, inverseY_, peak_;
};

template <class T>
using GgxTerms = FacetTerms<T, GgxFacets, GgxShape>;

void evalGgx(const FacetShape<GgxShape>& shape, const TermBatch& batch) {
    evalLanes<GgxTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
