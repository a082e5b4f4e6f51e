// A number type that fills a vector register: it evaluates a formula written for any number
// type `T` for several directions at a time. Compiled once for each instruction set.

#if defined(BRDFS_LANES_LANES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_H
#undef BRDFS_LANES_LANES_H
#else
#define BRDFS_LANES_LANES_H
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// One truth value for each lane.
struct LaneMask {
    using Mask = hn::Mask<hn::ScalableTag<double>>;
    Mask m;
};

/// As many doubles as a register holds. Arithmetic acts on each lane by itself, so that a result
/// does not depend on the lane.
struct Lanes {
    using Tag = hn::ScalableTag<double>;
    using Vector = hn::Vec<Tag>;
    Vector v;

    Lanes() = default;
    HWY_INLINE Lanes(double value) : v(hn::Set(Tag(), value)) {}
    HWY_INLINE explicit Lanes(Vector vector) : v(vector) {}

    friend HWY_INLINE Lanes operator+(Lanes a, Lanes b) { return Lanes(hn::Add(a.v, b.v)); }
    friend HWY_INLINE Lanes operator-(Lanes a, Lanes b) { return Lanes(hn::Sub(a.v, b.v)); }
    friend HWY_INLINE Lanes operator*(Lanes a, Lanes b) { return Lanes(hn::Mul(a.v, b.v)); }
    friend HWY_INLINE Lanes operator/(Lanes a, Lanes b) { return Lanes(hn::Div(a.v, b.v)); }
    friend HWY_INLINE Lanes operator-(Lanes a) { return Lanes(hn::Neg(a.v)); }
    friend HWY_INLINE LaneMask operator<(Lanes a, Lanes b) { return {hn::Lt(a.v, b.v)}; }
    friend HWY_INLINE LaneMask operator>(Lanes a, Lanes b) { return {hn::Gt(a.v, b.v)}; }
    friend HWY_INLINE LaneMask operator>=(Lanes a, Lanes b) { return {hn::Ge(a.v, b.v)}; }
};

/// a where the mask holds, else b. The value that is not selected may be anything, NaN included.
HWY_INLINE Lanes select(LaneMask mask, Lanes a, Lanes b) {
    return Lanes(hn::IfThenElse(mask.m, a.v, b.v));
}
HWY_INLINE double select(bool mask, double a, double b) {
    return mask ? a : b;
}

HWY_INLINE bool anyOf(LaneMask mask) {
    return !hn::AllFalse(Lanes::Tag(), mask.m);
}
HWY_INLINE bool anyOf(bool mask) {
    return mask;
}

HWY_INLINE Lanes min(Lanes a, Lanes b) {
    return Lanes(hn::Min(a.v, b.v));
}
HWY_INLINE double min(double a, double b) {
    return b < a ? b : a;
}
HWY_INLINE Lanes max(Lanes a, Lanes b) {
    return Lanes(hn::Max(a.v, b.v));
}
HWY_INLINE double max(double a, double b) {
    return b > a ? b : a;
}
HWY_INLINE Lanes abs(Lanes a) {
    return Lanes(hn::Abs(a.v));
}
HWY_INLINE double abs(double a) {
    return std::abs(a);
}
HWY_INLINE Lanes sqrt(Lanes a) {
    return Lanes(hn::Sqrt(a.v));
}
HWY_INLINE double sqrt(double a) {
    return std::sqrt(a);
}
/// To the integer below, of 0 or more and less than 2^31.
HWY_INLINE Lanes truncated(Lanes a) {
    return Lanes(hn::Trunc(a.v));
}
HWY_INLINE double truncated(double a) {
    return std::trunc(a);
}

/// table[index] for whole indices.
HWY_INLINE Lanes gather(const double* table, Lanes index) {
    // Adding 2^52 leaves the number in the lowest bits, faster than any conversion before AVX-512.
    const hn::RebindToSigned<Lanes::Tag> integers;
    const auto shifted = hn::BitCast(integers, (index + 0x1p52).v);
    const auto exponent = hn::Set(integers, 0x4330000000000000);
    return Lanes(hn::GatherIndex(Lanes::Tag(), table, hn::Sub(shifted, exponent)));
}
HWY_INLINE double gather(const double* table, double index) {
    return table[static_cast<std::size_t>(index)];
}

/// +inf becomes the largest double, so that a factor 0 met later gives 0 and not NaN.
template <class T>
HWY_INLINE T bounded(T value) {
    return min(value, T(std::numeric_limits<double>::max()));
}

/// The count of numbers in a T, and loads and stores of a T.
template <class T>
HWY_INLINE std::size_t lanesIn();
template <>
HWY_INLINE std::size_t lanesIn<double>() {
    return 1;
}
template <>
HWY_INLINE std::size_t lanesIn<Lanes>() {
    return hn::Lanes(Lanes::Tag());
}
HWY_INLINE void load(const double* from, Lanes& to) {
    to.v = hn::LoadU(Lanes::Tag(), from);
}
HWY_INLINE void load(const double* from, double& to) {
    to = *from;
}
HWY_INLINE void store(Lanes value, double* to) {
    hn::StoreU(value.v, Lanes::Tag(), to);
}
HWY_INLINE void store(double value, double* to) {
    *to = value;
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
