// Angles from sines and cosines, and the reverse, of Lanes and of double. Compiled once for each
// instruction set.

#if defined(BRDFS_LANES_LANES_ANGLES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_ANGLES_H
#undef BRDFS_LANES_LANES_ANGLES_H
#else
#define BRDFS_LANES_LANES_ANGLES_H
#endif

#include <brdfs/lanes/lanes.h>

#include <hwy/contrib/math/math-inl.h>

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// atan(y / x) for 0 <= y <= x, x > 0, within 3 units of the last place (Highway).
HWY_INLINE Lanes atanOfRatio(Lanes y, Lanes x) {
    return Lanes(hn::Atan(Lanes::Tag(), (y / x).v));
}
HWY_INLINE double atanOfRatio(double y, double x) {
    return std::atan(y / x);
}

/// For |x| < 39000, within 3 units of the last place of 1 (Highway); of double lanes_slopes_math.h.
HWY_INLINE Lanes cos(Lanes x) {
    return Lanes(hn::Cos(Lanes::Tag(), x.v));
}
HWY_INLINE Lanes sin(Lanes x) {
    return Lanes(hn::Sin(Lanes::Tag(), x.v));
}

/// The polar angle of a direction above the horizon and its complement; the smaller of the two
/// keeps all its digits.
template <class T>
struct PolarAngle {
    T theta, complement;

    HWY_INLINE PolarAngle(T sine, T cosine) {
        const auto steep = cosine < sine;
        const T smaller = atanOfRatio(select(steep, cosine, sine), select(steep, sine, cosine));
        const T other = T(std::numbers::pi / 2) - smaller;
        theta = select(steep, other, smaller);
        complement = select(steep, smaller, other);
    }
};

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
