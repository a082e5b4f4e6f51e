// GGX's distribution and masking (ggx.h) for any number T. Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_GGX_FACETS_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_GGX_FACETS_H
#undef BRDFS_ANALYTIC_GGX_FACETS_H
#else
#define BRDFS_ANALYTIC_GGX_FACETS_H
#endif

#include <brdfs/analytic/ggx_shape.h>
#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// A vector turned about the normal; x and y depend on the parameters.
template <class T>
struct Turned {
    T x, y;
    RealOf<T> z, squared;

    HWY_INLINE RealOf<T> squaredLength() const { return squared; }
};

/// From the tangent's frame to the frame of a lobe whose axes are turned by an angle.
template <class T>
struct Turn {
    T cosine, sine;  ///< of the angle

    HWY_INLINE Turned<T> operator()(const Incoming<RealOf<T>>& w, RealOf<T> squaredLength) const {
        return {cosine * w.x + sine * w.y, cosine * w.y - sine * w.x, w.z, squaredLength};
    }
};

template <class T>
class GgxFacets {
public:
    explicit HWY_INLINE GgxFacets(const GgxShape<ParameterOf<T>>& shape)
        : ax_(shape.r.ax), ay_(shape.r.ay), inverseX_(1 / shape.r.ax), inverseY_(1 / shape.r.ay) {
        peak_ = 1 / shape.r.ax * (1 / shape.r.ay) / pi;
    }

    /// |h|^4 / (pi ax ay (z^2 + (x/ax)^2 + (y/ay)^2)^2).
    template <class Half>
    HWY_INLINE T density(const Half& h) const {
        const T x = h.x * inverseX_, y = h.y * inverseY_;
        const T ratio = h.squaredLength() / (h.z * h.z + x * x + y * y);
        return ratio * ratio * peak_;
    }

    /// z Lambda(w), finite at the horizon, where Lambda is not.
    template <class W = Incoming<RealOf<T>>>
    HWY_INLINE T scaledLambda(const W& w) const {
        const T x = w.x * ax_, y = w.y * ay_, s = x * x + y * y;
        return 0.5 * s / (w.z + sqrt(w.z * w.z + s));
    }

    /// D times G / (4 cos_i cos_o), G with correlated heights; `outgoing` is scaledLambda(wo).
    template <class Half, class W, class R>
    HWY_INLINE T lobe(const Half& h, const W& wi, R outgoingZ, const T& outgoing) const {
        const T visible = wi.z * outgoingZ + outgoingZ * scaledLambda(wi) + wi.z * outgoing;
        return bounded(density(h) * bounded(0.25 / visible));
    }

private:
    T ax_, ay_, inverseX_, inverseY_, peak_;
};

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
