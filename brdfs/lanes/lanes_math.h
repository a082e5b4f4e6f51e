// Elementary functions of Lanes (lanes.h), and of double from the C++ library under the same names.
// Compiled once for each instruction set. `tests/brdfs/lanes_test.cpp` holds them to these bounds
// against the library, of the arguments that models have; in units of the last place, with fused
// multiply-adds and without:
//     exp        1.5  for x <= 709.78; beyond, infinity; 0 below -707 instead of down to 5e-324
//     log        1.0  for x > 0, subnormal numbers included
//     log1p      3.0  for x > -1; the sum 1 + x is rounded, unless it is near 1
//     expm1      3.0  for x <= 709.78
//     pow        exp(y log x): 1.5 + 2 |y log x|, for x >= 0
//     ierfc      no bound of its own: within 1e-15 of the exact value for x >= 0
// NaN does not stay NaN.

#if defined(BRDFS_LANES_LANES_MATH_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_MATH_H
#undef BRDFS_LANES_LANES_MATH_H
#else
#define BRDFS_LANES_LANES_MATH_H
#endif

#include <brdfs/lanes/lanes.h>

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

// Of the C++ library, so that formulas find them by the same names.
HWY_INLINE double exp(double x) {
    return std::exp(x);
}
HWY_INLINE double expm1(double x) {
    return std::expm1(x);
}
HWY_INLINE double log(double x) {
    return std::log(x);
}
HWY_INLINE double log1p(double x) {
    return std::log1p(x);
}
HWY_INLINE double pow(double x, double y) {
    return std::pow(x, y);
}

/// ln 2 in two parts; the first has 20 zeros at its end, so that its multiples are exact.
constexpr double ln2High = 0x1.62e42feep-1, ln2Low = 0x1.a39ef35793c76p-33;

/// a b + c, rounded once where the instruction set can.
HWY_INLINE Lanes fused(Lanes a, Lanes b, Lanes c) {
    return Lanes(hn::MulAdd(a.v, b.v, c.v));
}

/// 2^whole (1 + excess) = exp(x), with |excess| <= 0.42.
struct ExpParts {
    Lanes excess;
    hn::Vec<hn::RebindToSigned<Lanes::Tag>> whole;  ///< in the lowest 12 bits

    explicit HWY_INLINE ExpParts(Lanes x) {
        // Adding 1.5 2^52 rounds to whole numbers, and leaves these in the lowest bits.
        const Lanes shift = 0x1.8p52;
        const Lanes shifted = fused(x, std::numbers::log2e, shift), n = shifted - shift;
        whole = hn::BitCast(hn::RebindToSigned<Lanes::Tag>(), shifted.v);
        const Lanes r = fused(-n, ln2Low, fused(-n, ln2High, x));
        // (exp(r) - 1 - r) / r^2 at Chebyshev's nodes of +-ln(2)/2: exp errs by 1.7e-17.
        const Lanes r2 = r * r, r4 = r2 * r2;
        const Lanes c01 = fused(0.1666666666666666746, r, 0.50000000000000010314);
        const Lanes c23 = fused(0.0083333333333300381973, r, 0.041666666666623820532);
        const Lanes c45 = fused(0.00019841269863171556026, r, 0.0013888888917367080562);
        const Lanes c67 = fused(2.7557268276905696187e-6, r, 2.4801521057868205199e-5);
        const Lanes c89 = fused(2.5100472505694996003e-8, r, 2.7620201591031548792e-7);
        const Lanes high = fused(fused(c89, r4, fused(c67, r2, c45)), r4, fused(c23, r2, c01));
        excess = fused(high, r2, r);
    }

    /// value 2^(whole - 1), for a value near 1 that stays normal.
    HWY_INLINE Lanes halfScaled(Lanes value) const {
        const hn::RebindToSigned<Lanes::Tag> bits;
        const auto exponent = hn::ShiftLeft<52>(hn::Sub(whole, hn::Set(bits, 1)));
        return Lanes(hn::BitCast(Lanes::Tag(), hn::Add(hn::BitCast(bits, value.v), exponent)));
    }
};

HWY_INLINE Lanes exp(Lanes x) {
    const Lanes least = -707.0;
    const ExpParts parts(min(max(x, least), 710.0));
    const Lanes value = parts.halfScaled(parts.excess + 1.0);
    return Lanes(hn::IfThenElseZero((x >= least).m, hn::Add(value.v, value.v)));
}

HWY_INLINE Lanes expm1(Lanes x) {
    const ExpParts parts(min(max(x, -700.0), 710.0));
    const Lanes scale = parts.halfScaled(1.0);
    const Lanes half = fused(scale, parts.excess, scale - 0.5);
    return select(abs(x) < Lanes(0.34), parts.excess, half + half);
}

/// x = 2^exponent (1 + fraction) with sqrt(1/2) <= 1 + fraction < sqrt(2), for normal x.
struct LogParts {
    Lanes exponent, fraction;

    explicit HWY_INLINE LogParts(Lanes x) {
        const hn::RebindToSigned<Lanes::Tag> integers;
        const hn::RebindToUnsigned<Lanes::Tag> bits;
        // The exponent of x / sqrt(1/2) (its bits, as in fdlibm), as a double by way of 2^52.
        const auto sqrtHalf = hn::Set(integers, 0x3fe6a09e667f3bcd);
        const auto above = hn::Sub(hn::BitCast(integers, x.v), sqrtHalf);
        const auto biased =
            hn::ShiftRight<52>(hn::BitCast(bits, hn::Add(above, hn::Set(integers, 1023LL << 52))));
        const auto shifted = hn::Or(biased, hn::Set(bits, 0x4330000000000000));
        exponent = Lanes(hn::BitCast(Lanes::Tag(), shifted)) - (0x1p52 + 1023);
        const auto mantissa = hn::And(above, hn::Set(integers, 0x000fffffffffffff));
        fraction = Lanes(hn::BitCast(Lanes::Tag(), hn::Add(mantissa, sqrtHalf))) - 1.0;
    }
};

/// exponent ln 2 + log(1 + f) by the series of atanh in s = f / (2 + f) as in fdlibm's
/// e_log.c, whose coefficients these are.
HWY_INLINE Lanes logOf(Lanes exponent, Lanes f) {
    const Lanes s = f / (f + 2.0), z = s * s, w = z * z;
    const Lanes even =
        w * fused(w, fused(w, 0.1531383769920937332, 0.2222219843214978396), 0.3999999999940941908);
    const Lanes odd = z * fused(w,
                                fused(w, fused(w, 0.1479819860511658591, 0.1818357216161805012),
                                      0.2857142874366239149),
                                0.6666666666666735130);
    const Lanes halfSquare = 0.5 * (f * f);
    const Lanes low = fused(s, halfSquare + (even + odd), exponent * Lanes(ln2Low));
    return fused(exponent, ln2High, f - (halfSquare - low));
}

HWY_INLINE Lanes log(Lanes x) {
    const auto small = x < Lanes(std::numeric_limits<double>::min());
    const LogParts parts(select(small, x * 0x1p54, x));
    return logOf(parts.exponent - select(small, 54.0, 0.0), parts.fraction);
}

/// log(value) for normal value > 0, given excess = value - 1 as well, which near 1 has more digits.
HWY_INLINE Lanes logNearOne(Lanes value, Lanes excess) {
    const LogParts parts(value);
    const auto near = abs(parts.exponent) < Lanes(0.5);
    return logOf(parts.exponent, select(near, excess, parts.fraction));
}
HWY_INLINE double logNearOne(double value, double excess) {
    return excess > -0.5 ? std::log1p(excess) : std::log(value);
}

HWY_INLINE Lanes log1p(Lanes x) {
    return logNearOne(x + 1.0, x);
}

HWY_INLINE Lanes pow(Lanes x, Lanes y) {
    const Lanes power = exp(y * log(x));
    const auto zero = x < Lanes(5e-324);
    if (!anyOf(zero)) return power;
    const Lanes inf = std::numeric_limits<double>::infinity();
    return select(zero, select(y > Lanes(0.0), 0.0, select(y < Lanes(0.0), inf, 1.0)), power);
}

/// The integral of erfc from x on: exp(-x^2)/sqrt(pi) - x erfc(x).
HWY_INLINE double ierfc(double x) {
    return x < 27 ? std::exp(-x * x) * std::numbers::inv_sqrtpi - x * std::erfc(x) : 0;
}

/// exp(-x^2)/(1 + x)^2 times a polynomial in t = (x - 2.5)/(x + 2.5), which has the values of
/// (1 + x)^2 exp(x^2) ierfc(x) at Chebyshev's nodes of 0 <= x <= 7.
HWY_INLINE Lanes ierfc(Lanes x) {
    constexpr double c[] = {
        0.455377499087492933,     -0.226373752736306954,    0.0145395268738964978,
        0.084962736571938857,     -0.0588159341143043001,   0.00445803592461099473,
        0.013628844417130513,     -0.00510891470600753589,  -0.00187709452585626029,
        0.00122555934942836496,   0.000369111430180913346,  -0.000249201659289516099,
        -0.000104973077066416604, 0.0000419589564006362401, 0.0000327865145393798987,
        -1.80641380860952923e-6,  -8.53254147030418974e-6,  -3.46045703729615913e-6,
        -4.95686857997891977e-7};
    const Lanes y = min(x, 7.0);
    const Lanes beyond = y + 2.5, above = y + 1.0;
    const Lanes t = (y - 2.5) / beyond, t2 = t * t;
    Lanes even = c[18], odd = c[17];
    for (int i = 16; i >= 0; i -= 2) even = fused(even, t2, c[i]);
    for (int i = 15; i >= 1; i -= 2) odd = fused(odd, t2, c[i]);
    return exp(-(y * y)) * fused(odd, t, even) / (above * above);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
