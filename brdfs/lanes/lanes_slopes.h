// A number with its derivatives by n parameters (forward mode): a formula written for any number
// type is differentiated by the code that evaluates it. Compiled once for each instruction set.
//
// `Slopes<double, n>` is a parameter or a function of parameters alone; `Slopes<Lanes, n>` is a
// function of directions too. Directions themselves have no slopes and are plain Lanes.

#if defined(BRDFS_LANES_LANES_SLOPES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_SLOPES_H
#undef BRDFS_LANES_LANES_SLOPES_H
#else
#define BRDFS_LANES_LANES_SLOPES_H
#endif

#include <brdfs/lanes/lanes.h>

#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class S, class V>
concept WithoutSlopes = std::is_arithmetic_v<S> || std::is_same_v<S, V>;

template <class V, int n>
struct Slopes {
    V value;
    V by[n > 0 ? n : 1];

    Slopes() = default;
    template <WithoutSlopes<V> S>
    HWY_INLINE Slopes(S constant) : value(constant) {
        for (int i = 0; i < n; ++i) by[i] = V(0.0);
    }
    template <class Parameter>
    requires(std::is_same_v<Parameter, Slopes<double, n>> && !std::is_same_v<V, double>) HWY_INLINE
        Slopes(const Parameter& parameter)
        : value(parameter.value) {
        for (int i = 0; i < n; ++i) by[i] = V(parameter.by[i]);
    }

    /// A function of `a` with this value and this derivative by `a`.
    static HWY_INLINE Slopes chained(V value, V derivative, const Slopes& a) {
        Slopes result;
        result.value = value;
        for (int i = 0; i < n; ++i) result.by[i] = derivative * a.by[i];
        return result;
    }

    friend HWY_INLINE Slopes operator+(const Slopes& a, const Slopes& b) {
        Slopes sum;
        sum.value = a.value + b.value;
        for (int i = 0; i < n; ++i) sum.by[i] = a.by[i] + b.by[i];
        return sum;
    }
    friend HWY_INLINE Slopes operator-(const Slopes& a) { return chained(-a.value, V(-1.0), a); }
    friend HWY_INLINE Slopes operator-(const Slopes& a, const Slopes& b) {
        Slopes difference;
        difference.value = a.value - b.value;
        for (int i = 0; i < n; ++i) difference.by[i] = a.by[i] - b.by[i];
        return difference;
    }
    friend HWY_INLINE Slopes operator*(const Slopes& a, const Slopes& b) {
        Slopes product;
        product.value = a.value * b.value;
        for (int i = 0; i < n; ++i) product.by[i] = a.by[i] * b.value + a.value * b.by[i];
        return product;
    }
    friend HWY_INLINE Slopes operator/(const Slopes& a, const Slopes& b) {
        const V inverse = 1.0 / b.value;
        Slopes quotient;
        quotient.value = a.value / b.value;
        for (int i = 0; i < n; ++i) quotient.by[i] = (a.by[i] - quotient.value * b.by[i]) * inverse;
        return quotient;
    }

    template <WithoutSlopes<V> S>
    friend HWY_INLINE Slopes operator+(const Slopes& a, S b) {
        return chained(a.value + V(b), V(1.0), a);
    }
    template <WithoutSlopes<V> S>
    friend HWY_INLINE Slopes operator+(S a, const Slopes& b) {
        return b + a;
    }
    template <WithoutSlopes<V> S>
    friend HWY_INLINE Slopes operator-(const Slopes& a, S b) {
        return chained(a.value - V(b), V(1.0), a);
    }
    template <WithoutSlopes<V> S>
    friend HWY_INLINE Slopes operator-(S a, const Slopes& b) {
        return chained(V(a) - b.value, V(-1.0), b);
    }
    template <WithoutSlopes<V> S>
    friend HWY_INLINE Slopes operator*(const Slopes& a, S b) {
        return chained(a.value * V(b), V(b), a);
    }
    template <WithoutSlopes<V> S>
    friend HWY_INLINE Slopes operator*(S a, const Slopes& b) {
        return b * a;
    }
    template <WithoutSlopes<V> S>
    friend HWY_INLINE Slopes operator/(const Slopes& a, S b) {
        return chained(a.value / V(b), 1.0 / V(b), a);
    }
    template <WithoutSlopes<V> S>
    friend HWY_INLINE Slopes operator/(S a, const Slopes& b) {
        const V quotient = V(a) / b.value;
        return chained(quotient, -quotient / b.value, b);
    }

    friend HWY_INLINE auto operator<(const Slopes& a, const Slopes& b) { return a.value < b.value; }
    friend HWY_INLINE auto operator>(const Slopes& a, const Slopes& b) { return a.value > b.value; }
    friend HWY_INLINE auto operator>=(const Slopes& a, const Slopes& b) {
        return a.value >= b.value;
    }
    friend HWY_INLINE bool operator==(const Slopes& a, double b) { return a.value == b; }
};

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
