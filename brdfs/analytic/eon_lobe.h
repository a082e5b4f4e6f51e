// The two terms of eon.h for any number T. Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_EON_LOBE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_EON_LOBE_H
#undef BRDFS_ANALYTIC_EON_LOBE_H
#else
#define BRDFS_ANALYTIC_EON_LOBE_H
#endif

#include <brdfs/analytic/eon_shape.h>
#include <brdfs/analytic/term_values.h>
#include <brdfs/lanes/lanes_angles.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// The roughness of eon.h, with A (`single`) and M (`mean`).
template <class N>
struct EonSettings {
    N roughness;
    bool exact;

    N single() const { return 1 / (1 + (0.5 - 2 / (3 * pi)) * roughness); }
    N mean() const { return single() * (1 + (2. / 3 - 28 / (15 * pi)) * roughness); }
    EonShape<N> shape() const {
        return {roughness, exact, single(), roughness > N(0.0) ? 1 / (1 - mean()) : N(0.0)};
    }
    /// The weight of multiple scattering between facets: kd' / pi.
    N multiple(const N& kd) const {
        const N m = mean();
        return kd * kd * m / (1 - kd * (1 - m)) / pi;
    }
};

/// The roughness of the terms. At 0 the multiple scattering is 0; its slope, if asked for, is taken
/// at a roughness of `least`.
template <class N>
N eonRoughness(const N& roughness) {
    constexpr double least = 1e-6;
    if (isZero(roughness)) return roughness;
    return roughness + std::max(0.0, least - plain(roughness));
}

template <class T>
class EonTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 2;

    HWY_INLINE EonTerms(const EonShape<ParameterOf<T>>& shape, const OutgoingOf<T>& wo)
        : shape_(shape),
          wo_(wo),
          outgoing_(T(shape.scale) * missing({R(wo.x), R(wo.y), R(wo.z)})) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const R across = wi.x * wo_.x + wi.y * wo_.y;
        // 1 + across for unit vectors: half of |(x, y)_i + (x, y)_o|^2 + z_i^2 + z_o^2.
        const R sx = wi.x + R(wo_.x), sy = wi.y + R(wo_.y);
        const R opposite = 0.5 * (sx * sx + sy * sy + wi.z * wi.z + R(wo_.z * wo_.z));
        const T roughness(shape_.roughness);
        const T same = 1.0 + roughness * bounded(across / max(wi.z, R(wo_.z)));
        const T other = (1.0 - roughness) + roughness * opposite;
        term[0] = T(shape_.single) * select(across > R(0.0), same, other);
        term[1] = outgoing_ * missing(wi);
    }

private:
    /// 1 - E: the light that single scattering does not reflect.
    HWY_INLINE T missing(const Incoming<R>& w) const {
        const R g = shape_.exact ? exactG(sqrt(w.x * w.x + w.y * w.y), w.z) : approximateG(w.z);
        return max(T(0.0), 1.0 - T(shape_.single) * (1.0 + T(shape_.roughness / pi) * g));
    }

    /// (1 - S^3)/c = c (1 + S + S^2)/(1 + S), which is 0 at the horizon.
    static HWY_INLINE R exactG(R sine, R cosine) {
        const R rest = cosine * (1.0 + sine + sine * sine) / (1.0 + sine);
        const R theta = PolarAngle<R>(sine, cosine).theta;
        return sine * (theta - sine * cosine) + 2. / 3 * sine * (rest - 1.0);
    }

    /// Listing 1 of the paper: G / pi as a polynomial in 1 - cos.
    static HWY_INLINE R approximateG(R cosine) {
        const R d = 1.0 - cosine;
        return pi * d * (0.0571085289 + d * (0.491881867 + d * (-0.332181442 + d * 0.0714429953)));
    }

    EonShape<ParameterOf<T>> shape_;
    OutgoingOf<T> wo_;
    T outgoing_;
};

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
