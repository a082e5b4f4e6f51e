// The formulas of fresnel.h for any number T. Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_FRESNEL_TERMS_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_FRESNEL_TERMS_H
#undef BRDFS_ANALYTIC_FRESNEL_TERMS_H
#else
#define BRDFS_ANALYTIC_FRESNEL_TERMS_H
#endif

#include <brdfs/lanes/lanes.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
struct ComplexOf {
    T real, imaginary;

    HWY_INLINE T squaredLength() const { return real * real + imaginary * imaginary; }
};

/// The root in the first quadrant, for imaginary >= 0, without cancellation in either part.
/// `length` is the absolute value.
template <class T>
HWY_INLINE ComplexOf<T> squareRoot(T real, T imaginary, T length) {
    const T larger = sqrt(0.5 * (length + abs(real)));
    const T smaller = select(larger > T(0.0), 0.5 * imaginary / larger, T(0.0));
    const auto right = real >= T(0.0);
    return {select(right, larger, smaller), select(right, smaller, larger)};
}

template <class T, class R>
HWY_INLINE T reflectanceOfRoot(R c, R squaredSine, const ComplexOf<T>& g) {
    const ComplexOf<T> s1{c - g.real, g.imaginary}, s2{c + g.real, g.imaginary};
    const ComplexOf<T> p1{c * g.real - squaredSine, c * g.imaginary};
    const ComplexOf<T> p2{c * g.real + squaredSine, c * g.imaginary};
    const T across = s1.squaredLength() / s2.squaredLength();
    const T ratio = p1.squaredLength() / p2.squaredLength();
    return min(T(1.0), 0.5 * across * (1.0 + ratio));
}

/// N is double or ParameterOf<T>.
template <class T, class R, class N>
HWY_INLINE T reflectanceOf(R cosine, const N& eta, const N& k) {
    // The fourth power of a cosine below 1e-75 underflows; the reflectance there equals the
    // reflectance at the horizon.
    const R c = min(max(cosine, R(1e-75)), R(1.0));
    const R squaredSine = (1.0 - c) * (1.0 + c);
    const T real = c * c + T((eta - 1) * (eta + 1) - k * k);
    if (k == 0) {
        const T root = sqrt(abs(real));
        const auto right = real >= T(0.0);
        const ComplexOf<T> g{select(right, root, T(0.0)), select(right, T(0.0), root)};
        return reflectanceOfRoot(c, squaredSine, g);
    }
    const T imaginary = 2 * eta * k;
    return reflectanceOfRoot(
        c, squaredSine, squareRoot(real, imaginary, sqrt(real * real + imaginary * imaginary)));
}

template <class N>
HWY_INLINE N normalReflectanceOf(const N& eta, const N& k) {
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

template <class T>
HWY_INLINE T schlickWeightOf(T cosine) {
    const T rest = 1.0 - cosine;
    const T squared = rest * rest;
    return squared * squared * rest;
}

template <class T, class R, class N>
HWY_INLINE T schlickReflectanceOf(R cosine, const N& f0) {
    return T(f0) + T(1 - f0) * schlickWeightOf(cosine);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
