// log and log1p of Lanes; bounds in lanes_math.h. Compiled once for each instruction set.

#if defined(BRDFS_LANES_LANES_LOG_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_LOG_H
#undef BRDFS_LANES_LANES_LOG_H
#else
#define BRDFS_LANES_LANES_LOG_H
#endif

#include <brdfs/lanes/lanes_exp.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

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

/// log(value) for normal value > 0. excess = value - 1 is given too, with more digits near 1.
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

HWY_INLINE double log(double x) {
    return std::log(x);
}
HWY_INLINE double log1p(double x) {
    return std::log1p(x);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
