// Terms of beckmann.h. Included by beckmann.cpp once for each instruction set.

#include <brdfs/analytic/facet_terms.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class BeckmannFacets {
public:
    explicit HWY_INLINE BeckmannFacets(const BeckmannShape& shape)
        : ax_(shape.r.ax), ay_(shape.r.ay), inverseX_(1 / ax_), inverseY_(1 / ay_) {
        peak_ = inverseX_ * inverseY_ / pi;
    }

    HWY_INLINE T density(const HalfVector<T>& h) const {
        const T x = h.x * inverseX_, y = h.y * inverseY_, inverse = 1.0 / (h.z * h.z);
        const T rise = h.squaredLength() * inverse;
        return exp(-(x * x + y * y) * inverse) * rise * rise * peak_;
    }

    HWY_INLINE T scaledLambda(const Incoming<T>& w) const {
        const T x = w.x * ax_, y = w.y * ay_, s = sqrt(x * x + y * y);
        return 0.5 * s * ierfc(w.z / s);
    }

private:
    double ax_, ay_, inverseX_, inverseY_, peak_;
};

template <class T>
using BeckmannTerms = FacetTerms<T, BeckmannFacets, BeckmannShape>;

void evalBeckmann(const FacetShape<BeckmannShape>& shape, const TermBatch& batch) {
    evalLanes<BeckmannTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
