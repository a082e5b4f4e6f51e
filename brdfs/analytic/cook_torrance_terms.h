// Terms of cook_torrance.h. Included by cook_torrance.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// Fresnel's reflectance for unpolarised light. `inverse` is 1 / eta, so that a perfect mirror
/// (eta = infinity) needs no branch. Cook & Torrance's formula, times inverse throughout.
template <class T, class R, class N>
HWY_INLINE T fresnel(const N& inverse, R cosine) {
    // The square of a cosine below 1e-150 underflows; F is 1 there (or 0 for eta = 1).
    const R c = max(cosine, R(1e-150));
    const T ec = T(inverse) * c;
    const T g = sqrt(T((1 - inverse) * (1 + inverse)) + ec * ec);
    const T sum = g + ec, difference = g - ec;
    const T a = difference / sum;
    const T b = (c * sum - T(inverse)) / (c * difference + T(inverse));
    return 0.5 * a * a * (1.0 + b * b);
}

template <class T>
class CookTorranceTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = someTerms;

    HWY_INLINE CookTorranceTerms(const CookTorranceShape<N>& shape, const OutgoingOf<T>& wo)
        : shape_(shape), wo_(wo), inverse_(-1 / (shape.m * shape.m)), peak_(shape.peak) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const HalfVector<R> h(wo_, wi);
        const R squaredSlope = h.squaredSlope(), rise = 1.0 + squaredSlope;
        const T density = peak_ * exp(squaredSlope * inverse_) * rise * rise;
        const R cosine = h.dotOutgoing();
        const T lobe = bounded(density * bounded(vGrooveVisibility(h, wi.z, R(wo_.z))));
        for (const CookTorranceSurface<N>& surface : shape_.surfaces)
            *term++ = lobe * reflectance(surface, cosine);
    }

private:
    HWY_INLINE T reflectance(const CookTorranceSurface<N>& surface, R cosine) const {
        if (shape_.schlick) return schlickReflectanceOf<T>(cosine, surface.f0);
        if (surface.ior > N(0.0)) return reflectanceOf<T>(cosine, surface.ior, surface.k);
        return fresnel<T>(surface.inverse, cosine);
    }

    const CookTorranceShape<N>& shape_;
    OutgoingOf<T> wo_;
    T inverse_, peak_;
};

struct CookTorranceFormula {
    template <class T>
    using Terms = CookTorranceTerms<T>;

    template <class N>
    static CookTorranceShape<N> shape(const Values<N>& p) {
        const N m = p("m");
        return {m, 1 / (norm(p) * m * m), {surface(p)}, p.chosen("fresnel", "schlick")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("kd") / pi, {p("ks")}};
    }
    template <class N>
    static CookTorranceSurface<N> surface(const Values<N>& p) {
        if (!p.given("ior")) {
            const N f0 = p("F0");
            return {f0, (1 - sqrt(f0)) / (1 + sqrt(f0)), N(0.0), N(0.0)};
        }
        const N n = p("ior"), k = p.given("k") ? p("k") : N(0.0);
        return {normalReflectanceOf(n, k), 1 / n, n, k};
    }
    /// N of cook_torrance.h.
    template <class N>
    static double norm(const Values<N>& p) {
        return p.chosen("norm", "4") ? 4 * pi : p.chosen("norm", "pi") ? pi : pi * pi;
    }
};

void evalCookTorrance(const CookTorranceShape<double>& shape, const TermBatch& batch) {
    evalLanes<CookTorranceTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> cookTorranceColumns(const ColumnRequest& request) {
    return columnsOf<CookTorranceFormula, 2>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
