// exp and expm1 of Lanes; bounds in lanes_math.h. Compiled once for each instruction set.

#if defined(BRDFS_LANES_LANES_EXP_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_EXP_H
#undef BRDFS_LANES_LANES_EXP_H
#else
#define BRDFS_LANES_LANES_EXP_H
#endif

#include <brdfs/lanes/lanes.h>

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

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

HWY_INLINE double exp(double x) {
    return std::exp(x);
}
HWY_INLINE double expm1(double x) {
    return std::expm1(x);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
