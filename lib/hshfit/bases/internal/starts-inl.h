// The starts of the columns (m): places of directions, scaled numbers for start values beyond
// the range of the number type, and powers of sin(theta) and the azimuth; compiled once for
// every instruction set.

#if defined(HSHFIT_BASES_KERNELS_STARTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HSHFIT_BASES_KERNELS_STARTS_INL_H
#undef HSHFIT_BASES_KERNELS_STARTS_INL_H
#else
#define HSHFIT_BASES_KERNELS_STARTS_INL_H
#endif

#include <hshfit/bases/internal/long_orders.h>
#include <hshfit/bases/vectors-inl.h>

#include <cmath>
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

/// Inputs of the recurrences, one direction a lane: the distance y from the nearer end, `far` 1
/// where that is t = -1, F, W, and the azimuth. In double for either type: F^m multiplies the
/// rounding of F by m.
template <class D>
struct Place {
    using V = hn::Vec<D>;
    V distance, far, factor, weight, c, s;
};

template <class D, class Real, class V = hn::Vec<D>>
HWY_INLINE Place<D> placeAt(D d, const Recurrences<Real>& r, V px, V py, V mu) {
    const V zero = hn::Zero(d), one = hn::Set(d, 1);
    // The larger of |x| and |y| is taken out first, so that squares do not underflow.
    const V large = hn::Max(hn::Abs(px), hn::Abs(py));
    const auto pole = hn::Eq(large, zero);
    const V unit = hn::IfThenElse(pole, one, large);
    const V ux = hn::Div(px, unit), uy = hn::Div(py, unit);
    const V length = hn::Sqrt(hn::MulAdd(ux, ux, hn::Mul(uy, uy)));
    const V sine = hn::IfThenElse(pole, zero, hn::Mul(large, length));
    const auto below = hn::Lt(mu, zero);
    Place<D> place{zero,
                   zero,
                   sine,
                   one,
                   hn::IfThenElse(pole, one, hn::Div(ux, length)),
                   hn::IfThenElse(pole, zero, hn::Div(uy, length))};
    if (r.domain == Domain::sphere) {
        place.far = hn::IfThenElse(below, one, zero);
        place.distance = hn::Neg(hn::Div(hn::Mul(sine, sine), hn::Add(one, hn::Abs(mu))));
        return place;
    }
    const V above = hn::Max(mu, zero), onePlus = hn::Add(one, above);
    const V rest = hn::Div(hn::Mul(sine, sine), onePlus);
    const auto nearPole = hn::Le(rest, hn::Set(d, 0.5));
    const bool chord = r.domain == Domain::chord;
    const V nearer = hn::IfThenElse(nearPole, rest, above), twice = hn::Add(nearer, nearer);
    place.far = hn::IfThenElse(nearPole, chord ? one : zero, chord ? zero : one);
    const auto positive = hn::Gt(place.far, zero);
    place.distance = r.symmetric ? hn::Neg(twice) : hn::IfThenElse(positive, twice, hn::Neg(twice));
    place.factor = hn::Mul(sine, hn::Sqrt(hn::Div(chord ? one : above, onePlus)));
    if (!chord) place.factor = hn::Add(place.factor, place.factor);
    if (r.timesRootCosine) place.weight = hn::Sqrt(above);
    place.weight = hn::IfThenElse(below, zero, place.weight);
    return place;
}

/// Whether every power F^m W, m < order, stays in the range of Real, so that exponents can be left
/// out. A quarter of the range is kept back for differences: y >= F^2 / 4.
template <class Real, class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D> staysInRange(D d, V factor, V weight, int order) {
    const V tiny = hn::Set(d, std::numeric_limits<double>::min()), one = hn::Set(d, 1);
    const auto vanishes = hn::Or(hn::Lt(factor, tiny), hn::Lt(weight, tiny));
    const Scaled<D> base(hn::IfThenElse(vanishes, one, factor));
    const Scaled<D> first(hn::IfThenElse(vanishes, one, weight));
    const V lowest = hn::MulAdd(base.exponent, hn::Set(d, order - 1.0), first.exponent);
    return hn::AndNot(vanishes, hn::Gt(lowest, hn::Set(d, -1.5 * shiftOf<Real>)));
}

/// Starts p 2^(shift e) and azimuths a, b (cosine and sine, with normalisation and sign) of four
/// columns after the other, in double. Powers go by the fourth power, which makes four chains.
template <class Real, class D>
class Starts {
public:
    using V = hn::Vec<D>;
    V p[4], e[4], a[4], b[4];

    HWY_INLINE Starts(const Recurrences<Real>& recurrences, const Place<D>& place)
        : r(recurrences),
          noFactor(hn::Lt(place.factor, hn::Set(d, std::numeric_limits<double>::min()))),
          noWeight(hn::Lt(place.weight, hn::Set(d, std::numeric_limits<double>::min()))),
          product(hn::IfThenElse(noWeight, one(), place.weight)),
          base(hn::IfThenElse(noFactor, one(), place.factor)) {
        scaled = !hn::AllTrue(d, staysInRange<Real>(d, place.factor, place.weight, r.order));
        V re[4], im[4];  // (c + i s)^i
        re[0] = one(), im[0] = hn::Zero(d);
        re[1] = place.c, im[1] = place.s;
        multiply(re[1], im[1], re[1], im[1], re[2], im[2]);
        multiply(re[2], im[2], re[1], im[1], re[3], im[3]);
        multiply(re[2], im[2], re[2], im[2], c4, s4);
        for (int i = 0; i < 4; ++i) {
            const V scale =
                hn::Set(d, (i % 2 == 1 && r.condonShortley ? -1 : 1) / std::sqrt(hshfit::pi));
            chainA[i] = hn::Mul(re[i], scale);
            chainB[i] = hn::Mul(im[i], scale);
        }
        const V factor = place.factor, square = hn::Mul(factor, factor);
        power[0] = place.weight;
        power[1] = hn::Mul(power[0], factor);
        power[2] = hn::Mul(power[0], square);
        power[3] = hn::Mul(power[1], square);
        fourth = hn::Mul(square, square);
        if (scaled) startScaled();
    }

    /// Columns m .. m + 3, for m = 0, 4, 8, ... in turn; those from `order` on are unused.
    HWY_INLINE void next(int m) {
        for (int i = 0; i < 4; ++i) {
            const V c = hn::Set(d, r.starts[m + i < r.order ? m + i : 0]);
            if (scaled) {
                startOf<Real>(d, scaledPower[i], m + i > 0 ? hn::Or(noFactor, noWeight) : noWeight,
                              p[i], e[i]);
                p[i] = hn::Mul(p[i], c);
                scaledPower[i].multiply(scaledFourth);
            } else {
                p[i] = hn::Mul(power[i], c);
                e[i] = hn::Zero(d);
                power[i] = hn::Mul(power[i], fourth);
            }
            a[i] = chainA[i], b[i] = chainB[i];
            multiply(a[i], b[i], c4, s4, chainA[i], chainB[i]);
        }
        // The one function of m = 0 counts for cosine and sine.
        if (m == 0) a[0] = b[0] = hn::Set(d, 1 / std::sqrt(2 * hshfit::pi));
    }

    /// Placeholder for columns beyond the last.
    HWY_INLINE void end() {
        for (int i = 0; i < 4; ++i) p[i] = e[i] = a[i] = b[i] = hn::Zero(d);
    }

private:
    static constexpr D d{};
    static HWY_INLINE V one() { return hn::Set(d, 1); }

    static HWY_INLINE void multiply(V re, V im, V c, V s, V& toRe, V& toIm) {
        toRe = hn::NegMulAdd(im, s, hn::Mul(re, c));
        toIm = hn::MulAdd(re, s, hn::Mul(im, c));
    }

    HWY_INLINE void startScaled() {
        Scaled<D> square = base;
        square.multiply(base);
        scaledPower[0] = scaledPower[1] = scaledPower[2] = product;
        scaledPower[1].multiply(base);
        scaledPower[2].multiply(square);
        scaledPower[3] = scaledPower[1];
        scaledPower[3].multiply(square);
        scaledFourth = square;
        scaledFourth.multiply(square);
    }

    const Recurrences<Real>& r;
    hn::Mask<D> noFactor, noWeight;
    Scaled<D> product, base;
    bool scaled;
    V c4, s4, chainA[4], chainB[4], power[4], fourth;
    Scaled<D> scaledPower[4] = {product, product, product, product}, scaledFourth = base;
};

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
