// Loads and transposed stores that vector kernels of any room share; compiled once for every
// instruction set.

#if defined(HSHFIT_BASES_KERNELS_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HSHFIT_BASES_KERNELS_VECTORS_INL_H
#undef HSHFIT_BASES_KERNELS_VECTORS_INL_H
#else
#define HSHFIT_BASES_KERNELS_VECTORS_INL_H
#endif

#include <cstddef>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::bases::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Vectors of at most 64 bytes, whose number of lanes is known at compile time.
template <class Real>
using Wide = hn::CappedTag<Real, 64 / sizeof(Real)>;
template <class Real>
using Single = hn::CappedTag<Real, 1>;

template <class D>
inline constexpr std::size_t lanesOf = hn::MaxLanes(D());

template <class D>
HWY_INLINE hn::Vec<D> loadReal(D d, const double* p) {
    if constexpr (sizeof(hn::TFromD<D>) == sizeof(double)) {
        return hn::LoadU(d, p);
    } else if constexpr (lanesOf<D> == 1) {
        return hn::DemoteTo(d, hn::LoadU(hn::Rebind<double, D>(), p));
    } else {
#if HWY_TARGET != HWY_SCALAR
        const hn::Half<D> half;
        const hn::Rebind<double, hn::Half<D>> wide;
        return hn::Combine(d, hn::DemoteTo(half, hn::LoadU(wide, p + lanesOf<D> / 2)),
                           hn::DemoteTo(half, hn::LoadU(wide, p)));
#endif
    }
}

/// The first `count` lanes to to[0 .. count - 1].
template <std::size_t count, class D>
HWY_INLINE void storeFirst(D d, hn::Vec<D> v, hn::TFromD<D>* to) {
    [[maybe_unused]] constexpr std::size_t half = lanesOf<D> / 2;
    if constexpr (count == lanesOf<D>) {
        hn::StoreU(v, d, to);
    } else if constexpr (count > 0) {
#if HWY_TARGET != HWY_SCALAR
        const hn::Half<D> part;
        storeFirst<count <= half ? count : half>(part, hn::LowerHalf(part, v), to);
        if constexpr (count > half)
            storeFirst<count - half>(part, hn::UpperHalf(part, v), to + half);
#endif
    }
}

/// The last `count` lanes to to[0 .. count - 1].
template <std::size_t count, class D>
HWY_INLINE void storeLast(D d, hn::Vec<D> v, hn::TFromD<D>* to) {
    [[maybe_unused]] constexpr std::size_t half = lanesOf<D> / 2;
    if constexpr (count == lanesOf<D>) {
        hn::StoreU(v, d, to);
    } else if constexpr (count > 0) {
#if HWY_TARGET != HWY_SCALAR
        const hn::Half<D> part;
        constexpr std::size_t lower = count > half ? count - half : 0;
        storeLast<lower>(part, hn::LowerHalf(part, v), to);
        storeLast<count - lower>(part, hn::UpperHalf(part, v), to + lower);
#endif
    }
}

#if HWY_TARGET == HWY_SCALAR
template <class D, class V>
HWY_INLINE void transpose(D /*d*/, V* /*v*/) {}
#else
/// Transposes 2^n blocks of 16 bytes: on return block g of v[b] is what block b of v[g] was.
template <class D, class V>
HWY_INLINE void transposeBlocks(D d, V* HWY_RESTRICT v, std::size_t step) {
    constexpr std::size_t blocks = lanesOf<D> * sizeof(hn::TFromD<D>) / 16;
    static_assert(blocks <= 4);
    if constexpr (blocks == 2) {
        const V a = v[0], b = v[step];
        v[0] = hn::ConcatLowerLower(d, b, a);
        v[step] = hn::ConcatUpperUpper(d, b, a);
    } else if constexpr (blocks == 4) {
        const V a = v[0], b = v[step], c = v[2 * step], e = v[3 * step];
        const V ab0 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a);
        const V ab1 = hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a));
        const V ce0 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(e), c);
        const V ce1 = hn::OddEvenBlocks(e, hn::SwapAdjacentBlocks(c));
        v[0] = hn::ConcatLowerLower(d, ce0, ab0);
        v[step] = hn::ConcatLowerLower(d, ce1, ab1);
        v[2 * step] = hn::ConcatUpperUpper(d, ce0, ab0);
        v[3 * step] = hn::ConcatUpperUpper(d, ce1, ab1);
    }
}

/// v[i] lane j becomes v[j] lane i, lanesOf<D> vectors.
template <class D, class V>
HWY_INLINE void transpose(D d, V* HWY_RESTRICT v) {
    using T = hn::TFromD<D>;
    constexpr std::size_t n = lanesOf<D>, perBlock = n * sizeof(T) < 16 ? n : 16 / sizeof(T);
    if constexpr (perBlock == 2) {
        for (std::size_t g = 0; g < n; g += 2) {
            const V a = v[g], b = v[g + 1];
            v[g] = hn::InterleaveLower(d, a, b);
            v[g + 1] = hn::InterleaveUpper(d, a, b);
        }
    } else if constexpr (perBlock == 4) {
        const hn::Repartition<double, D> pairs;
        for (std::size_t g = 0; g < n; g += 4) {
            const auto ab0 = hn::BitCast(pairs, hn::InterleaveLower(d, v[g], v[g + 1]));
            const auto ab2 = hn::BitCast(pairs, hn::InterleaveUpper(d, v[g], v[g + 1]));
            const auto ce0 = hn::BitCast(pairs, hn::InterleaveLower(d, v[g + 2], v[g + 3]));
            const auto ce2 = hn::BitCast(pairs, hn::InterleaveUpper(d, v[g + 2], v[g + 3]));
            v[g] = hn::BitCast(d, hn::InterleaveLower(pairs, ab0, ce0));
            v[g + 1] = hn::BitCast(d, hn::InterleaveUpper(pairs, ab0, ce0));
            v[g + 2] = hn::BitCast(d, hn::InterleaveLower(pairs, ab2, ce2));
            v[g + 3] = hn::BitCast(d, hn::InterleaveUpper(pairs, ab2, ce2));
        }
    }
    for (std::size_t i = 0; i < perBlock && n > perBlock; ++i) transposeBlocks(d, v + i, perBlock);
}
#endif

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
