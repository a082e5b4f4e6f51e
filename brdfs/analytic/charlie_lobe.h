// The lobe of charlie.h for any number T. Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_CHARLIE_LOBE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_CHARLIE_LOBE_H
#undef BRDFS_ANALYTIC_CHARLIE_LOBE_H
#else
#define BRDFS_ANALYTIC_CHARLIE_LOBE_H
#endif

#include <brdfs/analytic/charlie_shape.h>
#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class N>
HWY_INLINE N charlieMixed(const N& share, double smooth, double rough) {
    return share * smooth + (1 - share) * rough;
}
template <class N>
HWY_INLINE CharlieCurve<N> charlieCurve(const N& r) {
    const N share = (1 - r) * (1 - r);
    return {1 / r,
            charlieMixed(share, 25.3245, 21.5473),
            charlieMixed(share, 3.32435, 3.82987),
            charlieMixed(share, 0.16801, 0.19823),
            charlieMixed(share, -1.27393, -1.97760),
            charlieMixed(share, -4.85967, -4.32054)};
}

template <class T>
class CharlieLobe {
    using R = RealOf<T>;

public:
    HWY_INLINE CharlieLobe(const CharlieCurve<ParameterOf<T>>& shape, R outgoingZ)
        : a_(shape.a),
          b_(shape.b),
          c_(shape.c),
          d_(shape.d),
          e_(shape.e),
          halfPower_(0.5 * shape.power),
          scale_((2 + shape.power) / (2 * pi)),
          half_(curve(R(0.5))),
          outgoingZ_(outgoingZ),
          outgoing_(lambda(outgoingZ)) {}

    HWY_INLINE T lambda(R cosine) const {
        const auto low = cosine < R(0.5);
        const T exponent = curve(select(low, cosine, 1.0 - cosine));
        return exp(select(low, exponent, 2.0 * half_ - exponent));
    }
    /// For z >= 0, its Lambda, and tan^2 of the half vector's angle to the normal.
    HWY_INLINE T operator()(R z, const T& incoming, R squaredSlope) const {
        const T visible = 0.25 / (1.0 + incoming + outgoing_) / max(z * outgoingZ_, R(5e-324));
        const R squaredSine = squaredSlope / (1.0 + squaredSlope);
        return scale_ * pow(squaredSine, halfPower_) * bounded(visible);
    }

private:
    HWY_INLINE T curve(R x) const { return a_ / (1.0 + b_ * pow(x, c_)) + d_ * x + e_; }

    T a_, b_, c_, d_, e_, halfPower_, scale_, half_;
    R outgoingZ_;
    T outgoing_;
};

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
