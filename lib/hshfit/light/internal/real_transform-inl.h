// Real Fourier transforms in the lanes of vectors; compiled once for every instruction set.

#if defined(HSHFIT_LIGHT_REAL_TRANSFORM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HSHFIT_LIGHT_REAL_TRANSFORM_INL_H
#undef HSHFIT_LIGHT_REAL_TRANSFORM_INL_H
#else
#define HSHFIT_LIGHT_REAL_TRANSFORM_INL_H
#endif

#include <hshfit/bases/vectors-inl.h>
#include <hshfit/light/internal/picture_spectra.h>
#include <hwy/highway.h>

#include <cstddef>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline light {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace shared = bases::kernels::HWY_NAMESPACE;
using Tag = shared::Wide<double>;
using FloatTag = hn::Rebind<float, Tag>;
using V = hn::Vec<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());
constexpr std::size_t group = SpectrumColumns::group;

HWY_INLINE V set(double value) {
    return hn::Set(Tag(), value);
}

// Real transforms keep n values in place: the real part of term k at k, k <= n / 2, and the
// imaginary part at n - k. Terms are sums of x_j exp(-2 pi i j k / n).

/// Even and odd halves of one term, E_k + w O_k and the conjugate of E_k - w O_k, to terms k and
/// n/2 - k; w = c (1 - i t).
HWY_INLINE void butterfly(V c, V t, V& evenRe, V& evenIm, V& oddRe, V& oddIm) {
    const V p = hn::MulAdd(t, oddIm, oddRe), q = hn::NegMulAdd(t, oddRe, oddIm);
    const V re = evenRe, im = evenIm;
    evenRe = hn::MulAdd(c, p, re);     // real part of term k
    oddIm = hn::MulAdd(c, q, im);      // its imaginary part
    evenIm = hn::NegMulAdd(c, p, re);  // real part of term n/2 - k
    oddRe = hn::MulSub(c, q, im);      // its imaginary part
}

/// cos(pi k / 16), k = 1 .. 7.
constexpr double eighths[8] = {1,
                               0.98078528040323044913,
                               0.92387953251128675613,
                               0.83146961230254523708,
                               0.70710678118654752440,
                               0.55557023301960222474,
                               0.38268343236508977173,
                               0.19509032201612826785};
/// Cosine and tangent of 2 pi k / n for n up to 32, k < n / 4.
constexpr double cosineOf(std::size_t n, std::size_t k) {
    return eighths[k * 32 / n];
}
constexpr double tangentOf(std::size_t n, std::size_t k) {
    return eighths[8 - k * 32 / n] / eighths[k * 32 / n];
}

template <int n, std::size_t... k>
HWY_INLINE void butterflies(V* v, std::index_sequence<k...>) {
    constexpr std::size_t half = n / 2;
    (butterfly(set(cosineOf(n, k + 1)), set(tangentOf(n, k + 1)), v[k + 1], v[half - k - 1],
               v[half + k + 1], v[n - k - 1]),
     ...);
}

/// n values in bit-reversed order, transformed in registers.
template <int n>
HWY_INLINE void transformInRegisters(V* v) {
    if constexpr (n > 1) {
        constexpr int half = n / 2;
        transformInRegisters<half>(v);
        transformInRegisters<half>(v + half);
        const V a = v[0], b = v[half];
        v[0] = hn::Add(a, b);
        v[half] = hn::Sub(a, b);
        if constexpr (half > 1) v[half + half / 2] = hn::Neg(v[half + half / 2]);
        if constexpr (half > 2) butterflies<n>(v, std::make_index_sequence<half / 2 - 1>());
    }
}

constexpr std::size_t reversed(std::size_t k, std::size_t n) {
    std::size_t result = 0;
    for (; n > 1; n /= 2, k /= 2) result = 2 * result + k % 2;
    return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace hshfit::inline light
HWY_AFTER_NAMESPACE();

#endif
