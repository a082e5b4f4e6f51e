// Compiled once for each instruction set; T is double or Lanes (lanes.h).

#if defined(BRDFS_ANALYTIC_HALF_VECTOR_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_HALF_VECTOR_H
#undef BRDFS_ANALYTIC_HALF_VECTOR_H
#else
#define BRDFS_ANALYTIC_HALF_VECTOR_H
#endif

#include <brdfs/analytic/term_batch.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// The half vector wi + wo, not normalised. It is formed from vectors rather than angles, so
/// that x and y, which determine a sharp lobe, keep all their digits. A very short one (opposite
/// directions at the horizon) is divided by its largest component, so that no square underflows.
template <class T>
struct HalfVector {
    T x, y, z;  ///< z at least `leastZ`
    T scale;    ///< wi + wo = scale (x, y, z)

    /// Slopes are cut at 2e70, where every lobe is 0, so that their powers times exp(-slope^2)
    /// stay finite.
    static constexpr double leastZ = 1e-70;

    template <class Outgoing>
    HWY_INLINE HalfVector(const Outgoing& wo, const Incoming<T>& wi)
        : x(wi.x + T(wo.x)), y(wi.y + T(wo.y)), z(wi.z + T(wo.z)), scale(1.0) {
        const T largest = max(max(abs(x), abs(y)), z);
        const auto isShort = largest < T(1e-30);
        if (anyOf(isShort)) {
            scale = select(isShort, largest, T(1.0));
            x = x / scale, y = y / scale, z = z / scale;
        }
        z = max(z, T(leastZ));
    }

    HWY_INLINE T squaredLength() const { return x * x + y * y + z * z; }
    /// tan^2 of the angle to the normal.
    HWY_INLINE T squaredSlope() const { return (x * x + y * y) / (z * z); }
    /// Cosine of the angle to either direction: half the length of wi + wo. At most 1.
    HWY_INLINE T dotOutgoing() const { return min(T(1.0), 0.5 * scale * sqrt(squaredLength())); }
    template <class V>
    HWY_INLINE V overSquaredScale(const V& value) const {
        return anyOf(scale < T(1.0)) ? value / scale / scale : value;
    }
};

/// 1 - cos(theta_h) from the squared slope, with all digits for small slopes.
template <class T>
HWY_INLINE T slopeVersine(T squaredSlope) {
    const T secant = sqrt(1.0 + squaredSlope);
    return squaredSlope / (secant * (1.0 + secant));
}

/// G / (cos_i cos_o) with the masking of V-shaped grooves,
///     G = min(1, 2 h.z cos_o / (h.wo), 2 h.z cos_i / (h.wo)),   h normalised,
/// the cosines divided out term by term. The result may be infinite where both directions graze.
/// Torrance & Sparrow 1967, 10.1364/JOSA.57.001105. It has kinks where the minimum changes
/// branches.
template <class T>
HWY_INLINE T vGrooveVisibility(const HalfVector<T>& h, T cosI, T cosO) {
    const T open = 1.0 / (cosI * cosO);
    const T blocked = 2.0 * h.z / (sqrt(h.squaredLength()) * h.dotOutgoing() * max(cosI, cosO));
    return min(open, blocked);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
