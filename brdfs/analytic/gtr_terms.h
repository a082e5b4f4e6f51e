// Terms of gtr.h. Included by gtr.cpp once for each instruction set.

#include <brdfs/analytic/facet_terms.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class GtrFacets {
public:
    explicit HWY_INLINE GtrFacets(const GtrShape<double>& shape)
        : squaredAlpha_(shape.alpha * shape.alpha),
          gamma_(shape.gamma),
          peak_(shape.peak),
          table_(*shape.table) {}

    HWY_INLINE T density(const HalfVector<T>& h) const {
        const T slope = h.squaredSlope();
        return peak_ * exp(gamma_ * log((1.0 + slope) / (1.0 + slope / squaredAlpha_)));
    }

    HWY_INLINE T scaledLambda(const Incoming<T>& w) const {
        const T squaredSine = w.x * w.x + w.y * w.y, s = squaredAlpha_ * squaredSine;
        const T ggx = 0.5 * s / (w.z + sqrt(w.z * w.z + s));
        return ggx * ratio(log(w.z / sqrt(squaredSine)));
    }

private:
    /// Cubic through the four nearest nodes.
    HWY_INLINE T ratio(T logCotangent) const {
        const double last = static_cast<double>(table_.values.size() - 1);
        const T at = min(max((logCotangent - table_.low) / table_.step, T(0.0)), T(last));
        const T left = min(max(truncated(at), T(1.0)), T(last - 2)) - T(1.0);
        const double* v = table_.values.data();
        const T u = at - left - 1.0, a = u + 1.0, b = u - 1.0, c = u - 2.0;
        return exp(-u * b * c * (1. / 6) * gather(v, left) + a * b * c * 0.5 * gather(v + 1, left) -
                   a * u * c * 0.5 * gather(v + 2, left) +
                   a * u * b * (1. / 6) * gather(v + 3, left));
    }

    double squaredAlpha_, gamma_, peak_;
    const LambdaTable& table_;
};

template <class T>
using GtrTerms = FacetTerms<T, GtrFacets, GtrShape>;

void evalGtr(const FacetShape<GtrShape<double>>& shape, const TermBatch& batch) {
    evalLanes<GtrTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
