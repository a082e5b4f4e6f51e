// Elementary functions of Slopes (lanes_slopes.h). Compiled once for each instruction set.

#if defined(BRDFS_LANES_LANES_SLOPES_MATH_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_SLOPES_MATH_H
#undef BRDFS_LANES_LANES_SLOPES_MATH_H
#else
#define BRDFS_LANES_LANES_SLOPES_MATH_H
#endif

#include <brdfs/lanes/lanes_math.h>
#include <brdfs/lanes/lanes_slopes.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class Mask, class V, int n>
HWY_INLINE Slopes<V, n> select(Mask mask, const Slopes<V, n>& a, const Slopes<V, n>& b) {
    Slopes<V, n> result;
    result.value = select(mask, a.value, b.value);
    for (int i = 0; i < n; ++i) result.by[i] = select(mask, a.by[i], b.by[i]);
    return result;
}
template <class V, int n>
HWY_INLINE Slopes<V, n> min(const Slopes<V, n>& a, const Slopes<V, n>& b) {
    return select(b < a, b, a);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> max(const Slopes<V, n>& a, const Slopes<V, n>& b) {
    return select(b > a, b, a);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> abs(const Slopes<V, n>& a) {
    return select(a < 0.0, -a, a);
}

/// The infinite slope at 0 is cut, so that a constant 0 has the slope 0.
template <class V, int n>
HWY_INLINE Slopes<V, n> sqrt(const Slopes<V, n>& a) {
    const V root = sqrt(a.value);
    return Slopes<V, n>::chained(root, 0.5 / max(root, V(1e-150)), a);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> exp(const Slopes<V, n>& a) {
    const V power = exp(a.value);
    return Slopes<V, n>::chained(power, power, a);
}
HWY_INLINE double exp2(double a) {
    return std::exp2(a);
}
template <int n>
HWY_INLINE Slopes<double, n> exp2(const Slopes<double, n>& a) {
    const double power = std::exp2(a.value);
    return Slopes<double, n>::chained(power, power * std::numbers::ln2, a);
}
HWY_INLINE double sin(double a) {
    return std::sin(a);
}
HWY_INLINE double cos(double a) {
    return std::cos(a);
}
/// For Lanes, the sin and cos of the values are from lanes_angles.h.
template <class V, int n>
HWY_INLINE Slopes<V, n> sin(const Slopes<V, n>& a) {
    return Slopes<V, n>::chained(sin(a.value), cos(a.value), a);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> cos(const Slopes<V, n>& a) {
    return Slopes<V, n>::chained(cos(a.value), -sin(a.value), a);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> expm1(const Slopes<V, n>& a) {
    const V less = expm1(a.value);
    return Slopes<V, n>::chained(less, less + 1.0, a);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> log(const Slopes<V, n>& a) {
    return Slopes<V, n>::chained(log(a.value), 1.0 / a.value, a);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> log1p(const Slopes<V, n>& a) {
    return Slopes<V, n>::chained(log1p(a.value), 1.0 / (a.value + 1.0), a);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> logNearOne(const Slopes<V, n>& value, const Slopes<V, n>& excess) {
    return Slopes<V, n>::chained(logNearOne(value.value, excess.value), 1.0 / value.value, value);
}
/// The slopes are 0 where x is 0.
template <class V, int n>
HWY_INLINE Slopes<V, n> pow(const Slopes<V, n>& x, const Slopes<V, n>& y) {
    const V power = pow(x.value, y.value), byX = power * y.value / x.value,
            byY = power * log(x.value);
    Slopes<V, n> result(power);
    for (int i = 0; i < n; ++i)
        result.by[i] = select(x.value > V(0.0), byX * x.by[i] + byY * y.by[i], V(0.0));
    return result;
}
template <int n>
HWY_INLINE Slopes<Lanes, n> pow(Lanes x, const Slopes<Lanes, n>& y) {
    const Lanes power = pow(x, y.value);
    return Slopes<Lanes, n>::chained(power, select(x > Lanes(0.0), power * log(x), 0.0), y);
}
template <class V, int n>
HWY_INLINE Slopes<V, n> ierfc(const Slopes<V, n>& a) {
    return Slopes<V, n>::chained(ierfc(a.value), -erfc(a.value), a);
}

template <int n>
HWY_INLINE Slopes<Lanes, n> gather(const Slopes<double, n>* table, Lanes index) {
    const Lanes at = index * static_cast<double>(sizeof(*table) / sizeof(double));
    Slopes<Lanes, n> result;
    result.value = gather(&table->value, at);
    for (int i = 0; i < n; ++i) result.by[i] = gather(table->by + i, at);
    return result;
}

/// Whether a parameter is the constant 0.
HWY_INLINE bool isZero(double a) {
    return a == 0;
}
template <int n>
HWY_INLINE bool isZero(const Slopes<double, n>& a) {
    bool zero = a.value == 0;
    for (int i = 0; i < n; ++i) zero = zero && a.by[i] == 0;
    return zero;
}

/// The number without its slopes.
template <class T>
HWY_INLINE T plain(T a) {
    return a;
}
template <class V, int n>
HWY_INLINE V plain(const Slopes<V, n>& a) {
    return a.value;
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
