// The recurrence of one column (one m) for a block of directions, one a lane; compiled once for
// every instruction set.

#if defined(HSHFIT_BASES_KERNELS_COLUMNS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HSHFIT_BASES_KERNELS_COLUMNS_INL_H
#undef HSHFIT_BASES_KERNELS_COLUMNS_INL_H
#else
#define HSHFIT_BASES_KERNELS_COLUMNS_INL_H
#endif

#include <hshfit/bases/internal/long_orders.h>
#include <hshfit/bases/internal/starts-inl.h>

#include <limits>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::bases::kernels::HWY_NAMESPACE {

/// Rescales lanes that have grown, towards exponent 0.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void wakeUp(D tag, V& p, V& d, V& e) {
    using T = hn::TFromD<D>;
    const V small = hn::Set(tag, powerOfTwo<T>(-shiftOf<T>));
    const V big = hn::Set(tag, powerOfTwo<T>(shiftOf<T> / 2));
    const auto grown =
        hn::And(hn::Lt(e, hn::Zero(tag)), hn::Ge(hn::Max(hn::Abs(p), hn::Abs(d)), big));
    p = hn::IfThenElse(grown, hn::Mul(p, small), p);
    d = hn::IfThenElse(grown, hn::Mul(d, small), d);
    e = hn::IfThenElse(grown, hn::Add(e, hn::Set(tag, 1)), e);
}

/// p 2^(shift e), values below the normal numbers flushed to 0.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V valueOf(D tag, V p, V e) {
    using T = hn::TFromD<D>;
    const V zero = hn::Zero(tag), one = hn::Set(tag, 1);
    const V small = hn::Set(tag, powerOfTwo<T>(-shiftOf<T>));
    V result = hn::Mul(p, hn::IfThenElse(hn::Lt(e, zero), small, one));
    result = hn::Mul(result, hn::IfThenElse(hn::Lt(e, hn::Set(tag, -1)), small, one));
    result = hn::IfThenElse(hn::Lt(e, hn::Set(tag, -2)), zero, result);
    const auto normal = hn::Ge(hn::Abs(result), hn::Set(tag, std::numeric_limits<T>::min()));
    return hn::IfThenElse(normal, result, zero);
}

/// One column in a block of `vectors` vectors.
template <class D, int vectors>
struct Column {
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    static constexpr std::size_t n = lanesOf<D>, width = n * vectors;

    V y[vectors], side[vectors], p[vectors], d[vectors], e[vectors];
    bool awake;  ///< e = 0 in all lanes

    HWY_INLINE Column(const T* distances, const T* sides, const T* starts, const T* exponents) {
        awake = true;
        for (int v = 0; v < vectors; ++v) {
            y[v] = hn::Load(D(), distances + v * n);
            side[v] = hn::Load(D(), sides + v * n);
            p[v] = hn::Load(D(), starts + v * n);
            d[v] = hn::Zero(D());
            e[v] = hn::Load(D(), exponents + v * n);
            awake = awake && hn::AllFalse(D(), hn::Lt(e[v], hn::Zero(D())));
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

    /// Functions k = 0 .. count - 1 of the column: take(k, v, values).
    template <bool mirrored, class Take>
    HWY_INLINE void run(const Step<T>* one, const Step<T>* other, int count, Take take) {
        int k = 0;
        for (; k < count && !awake; ++k) {
            if (k > 0) {
                advance<mirrored>(one[k - 1], other[k - 1]);
                awake = true;
                for (int v = 0; v < vectors; ++v) {
                    wakeUp(D(), p[v], d[v], e[v]);
                    awake = awake && hn::AllFalse(D(), hn::Lt(e[v], hn::Zero(D())));
                }
            }
            for (int v = 0; v < vectors; ++v) take(k, v, valueOf(D(), p[v], e[v]));
        }
        if (k == 0) {
            for (int v = 0; v < vectors; ++v) take(0, v, p[v]);
            ++k;
        }
        for (; k < count; ++k) {
            advance<mirrored>(one[k - 1], other[k - 1]);
            for (int v = 0; v < vectors; ++v) take(k, v, p[v]);
        }
    }
};

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
