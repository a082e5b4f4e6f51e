// The two terms of eon.h for any number T. Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_EON_LOBE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_EON_LOBE_H
#undef BRDFS_ANALYTIC_EON_LOBE_H
#else
#define BRDFS_ANALYTIC_EON_LOBE_H
#endif

#include <brdfs/analytic/eon_shape.h>
#include <brdfs/analytic/term_batch.h>
#include <brdfs/lanes/lanes_angles.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class EonTerms {
public:
    static constexpr std::size_t count = 2;

    HWY_INLINE EonTerms(const EonShape& shape, const Direction& wo)
        : shape_(shape), wo_(wo), outgoing_(shape.scale * missing({T(wo.x), T(wo.y), T(wo.z)})) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const T across = wi.x * wo_.x + wi.y * wo_.y;
        // 1 + across for unit vectors: half of |(x, y)_i + (x, y)_o|^2 + z_i^2 + z_o^2.
        const T sx = wi.x + T(wo_.x), sy = wi.y + T(wo_.y);
        const T opposite = 0.5 * (sx * sx + sy * sy + wi.z * wi.z + T(wo_.z * wo_.z));
        const T same = 1.0 + shape_.roughness * bounded(across / max(wi.z, T(wo_.z)));
        const T other = (1 - shape_.roughness) + shape_.roughness * opposite;
        term[0] = shape_.single * select(across > T(0.0), same, other);
        term[1] = outgoing_ * missing(wi);
    }

private:
    /// 1 - E: the light that single scattering does not reflect.
    HWY_INLINE T missing(const Incoming<T>& w) const {
        const T g = shape_.exact ? exactG(sqrt(w.x * w.x + w.y * w.y), w.z) : approximateG(w.z);
        return max(T(0.0), 1.0 - shape_.single * (1.0 + shape_.roughness / pi * g));
    }

    /// (1 - S^3)/c = c (1 + S + S^2)/(1 + S), which is 0 at the horizon.
    static HWY_INLINE T exactG(T sine, T cosine) {
        const T rest = cosine * (1.0 + sine + sine * sine) / (1.0 + sine);
        const T theta = PolarAngle<T>(sine, cosine).theta;
        return sine * (theta - sine * cosine) + 2. / 3 * sine * (rest - 1.0);
    }

    /// Listing 1 of the paper: G / pi as a polynomial in 1 - cos.
    static HWY_INLINE T approximateG(T cosine) {
        const T d = 1.0 - cosine;
        return pi * d * (0.0571085289 + d * (0.491881867 + d * (-0.332181442 + d * 0.0714429953)));
    }

    EonShape shape_;
    Direction wo_;
    T outgoing_;
};

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
