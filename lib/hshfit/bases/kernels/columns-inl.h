// The recurrence of one column (one m) for a block of directions, and the scaled numbers that it
// starts from; compiled once for every instruction set.

#if defined(HSHFIT_BASES_KERNELS_COLUMNS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HSHFIT_BASES_KERNELS_COLUMNS_INL_H
#undef HSHFIT_BASES_KERNELS_COLUMNS_INL_H
#else
#define HSHFIT_BASES_KERNELS_COLUMNS_INL_H
#endif

#include <hshfit/bases/kernels/long_orders.h>
#include <hshfit/bases/kernels/vectors-inl.h>

#include <cstdint>
#include <limits>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::bases::kernels::HWY_NAMESPACE {

/// mantissa 2^exponent with a mantissa in [1, 2) once it is normalised. No zeros.
template <class D>
struct Scaled {
    using V = hn::Vec<D>;
    V mantissa, exponent;

    HWY_INLINE explicit Scaled(V x) : mantissa(x), exponent(hn::Zero(D())) { normalise(); }

    HWY_INLINE void normalise() {
        const D d;
        const hn::RebindToUnsigned<D> bits;
        const auto x = hn::BitCast(bits, mantissa);
        // The exponent field as the low bits of 2^52 + field.
        const V field =
            hn::BitCast(d, hn::Or(hn::ShiftRight<52>(x), hn::Set(bits, 0x4330000000000000u)));
        exponent = hn::Add(exponent, hn::Sub(field, hn::Set(d, 4503599627370496.0 + 1023)));
        mantissa = hn::BitCast(d, hn::Or(hn::And(x, hn::Set(bits, 0x000FFFFFFFFFFFFFu)),
                                         hn::Set(bits, 0x3FF0000000000000u)));
    }

    HWY_INLINE void multiply(const Scaled& other) {
        mantissa = hn::Mul(mantissa, other.mantissa);
        exponent = hn::Add(exponent, other.exponent);
        normalise();
    }
};

/// Values of a column are p 2^(shift e), e <= 0, with |p| < 2^(shift/2) as long as e < 0.
template <class Real>
inline constexpr int shiftOf = std::numeric_limits<Real>::max_exponent / 2;

/// 2^exponent for an integer exponent in the range of normal numbers.
template <class Real>
constexpr Real powerOfTwo(int exponent) {
    Real value = 1;
    for (int i = 0; i < (exponent < 0 ? -exponent : exponent); ++i)
        value *= exponent < 0 ? 0.5f : 2;
    return value;
}

/// `x` as p (without its factor c_m) and e; 0 where `zero`.
template <class Real, class D, class V, class M>
HWY_INLINE void startOf(D d, const Scaled<D>& x, M zero, V& p, V& e) {
    const hn::RebindToUnsigned<D> bits;
    constexpr double shift = shiftOf<Real>;
    const V below = hn::Sub(hn::Set(d, -shift / 2), x.exponent);
    e = hn::Neg(hn::Ceil(hn::Mul(hn::Max(below, hn::Zero(d)), hn::Set(d, 1 / shift))));
    const V rest = hn::NegMulAdd(e, hn::Set(d, shift), x.exponent);
    const V biased = hn::Add(rest, hn::Set(d, 4503599627370496.0 + 1023));
    const V power = hn::BitCast(d, hn::ShiftLeft<52>(hn::BitCast(bits, biased)));
    p = hn::IfThenElse(zero, hn::Zero(d), hn::Mul(x.mantissa, power));
    e = hn::IfThenElse(zero, hn::Zero(d), e);
}

/// A double vector to numbers of type Real.
template <class D, class Real>
HWY_INLINE void storeReal(D d, hn::Vec<D> v, Real* to) {
    if constexpr (sizeof(Real) == sizeof(double))
        hn::StoreU(v, d, to);
    else
        hn::StoreU(hn::DemoteTo(hn::Rebind<float, D>(), v), hn::Rebind<float, D>(), to);
}

/// The state of one column in a block of `vectors` vectors: what lies between two functions.
template <class D, int vectors>
struct Column {
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    static constexpr std::size_t n = lanesOf<D>, width = n * vectors;

    V y[vectors], side[vectors], p[vectors], d[vectors], e[vectors];
    bool awake;  ///< e = 0 in all lanes

    HWY_INLINE void place(const T* distance, const T* sides) {
        for (int v = 0; v < vectors; ++v) {
            y[v] = hn::Load(D(), distance + v * n);
            side[v] = hn::Load(D(), sides + v * n);
        }
    }

    HWY_INLINE void resume(const T* values, const T* differences, const T* exponents) {
        awake = true;
        for (int v = 0; v < vectors; ++v) {
            p[v] = hn::Load(D(), values + v * n);
            d[v] = differences ? hn::Load(D(), differences + v * n) : hn::Zero(D());
            e[v] = hn::Load(D(), exponents + v * n);
            awake = awake && hn::AllFalse(D(), hn::Lt(e[v], hn::Zero(D())));
        }
    }

    HWY_INLINE void save(T* values, T* differences, T* exponents) const {
        for (int v = 0; v < vectors; ++v) {
            hn::Store(p[v], D(), values + v * n);
            hn::Store(d[v], D(), differences + v * n);
            hn::Store(e[v], D(), exponents + v * n);
        }
    }

    /// `mirrored`: the lanes at the end t = -1 run as at t = 1, every other function with the
    /// wrong sign, which symmetric weights allow.
    template <bool mirrored>
    HWY_INLINE void advance(const Step<T>& one, const Step<T>& other) {
        const D tag;
        const V zero = hn::Zero(tag);
        for (int v = 0; v < vectors; ++v) {
            V slope = hn::Set(tag, one.slope), ratio = hn::Set(tag, one.ratio),
              carry = hn::Set(tag, one.carry);
            if constexpr (!mirrored) {
                const auto far = hn::Gt(side[v], zero);
                slope = hn::IfThenElse(far, hn::Set(tag, other.slope), slope);
                ratio = hn::IfThenElse(far, hn::Set(tag, other.ratio), ratio);
                carry = hn::IfThenElse(far, hn::Set(tag, other.carry), carry);
            }
            d[v] = hn::MulAdd(hn::Mul(slope, y[v]), p[v], hn::Mul(carry, d[v]));
            p[v] = hn::MulAdd(ratio, p[v], d[v]);
        }
    }

    /// Lanes that have grown come nearer to exponent 0.
    HWY_INLINE void wake() {
        const D tag;
        const V big = hn::Set(tag, powerOfTwo<T>(shiftOf<T> / 2));
        const V small = hn::Set(tag, powerOfTwo<T>(-shiftOf<T>)), zero = hn::Zero(tag);
        awake = true;
        for (int v = 0; v < vectors; ++v) {
            const auto grown =
                hn::And(hn::Lt(e[v], zero), hn::Ge(hn::Max(hn::Abs(p[v]), hn::Abs(d[v])), big));
            p[v] = hn::IfThenElse(grown, hn::Mul(p[v], small), p[v]);
            d[v] = hn::IfThenElse(grown, hn::Mul(d[v], small), d[v]);
            e[v] = hn::IfThenElse(grown, hn::Add(e[v], hn::Set(tag, 1)), e[v]);
            awake = awake && hn::AllFalse(tag, hn::Lt(e[v], zero));
        }
    }

    /// p 2^(shift e), values below the normal numbers flushed to 0.
    HWY_INLINE V value(int v) const {
        const D tag;
        const V zero = hn::Zero(tag), one = hn::Set(tag, 1);
        const V small = hn::Set(tag, powerOfTwo<T>(-shiftOf<T>));
        V result = hn::Mul(p[v], hn::IfThenElse(hn::Lt(e[v], zero), small, one));
        result = hn::Mul(result, hn::IfThenElse(hn::Lt(e[v], hn::Set(tag, -1)), small, one));
        result = hn::IfThenElse(hn::Lt(e[v], hn::Set(tag, -2)), zero, result);
        const auto normal = hn::Ge(hn::Abs(result), hn::Set(tag, std::numeric_limits<T>::min()));
        return hn::IfThenElse(normal, result, zero);
    }

    /// Functions k = from .. to - 1 of the column; take(k, v, values). The state is at `from` if
    /// `fresh`, else at from - 1; on return it is at to - 1.
    template <bool mirrored, class Take>
    HWY_INLINE void run(const Step<T>* one, const Step<T>* other, int from, int to, bool fresh,
                        const Take& take) {
        int k = from;
        for (bool first = fresh; k < to && !awake; first = false, ++k) {
            if (!first) {
                advance<mirrored>(one[k - 1], other[k - 1]);
                wake();
            }
            for (int v = 0; v < vectors; ++v) take(k, v, value(v));
        }
        if (fresh && k == from && k < to) {
            for (int v = 0; v < vectors; ++v) take(k, v, p[v]);
            ++k;
        }
        for (; k < to; ++k) {
            advance<mirrored>(one[k - 1], other[k - 1]);
            for (int v = 0; v < vectors; ++v) take(k, v, p[v]);
        }
    }
};

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
