// Terms of cook_torrance.h. Included by cook_torrance.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// Fresnel's reflectance for unpolarised light; `inverse` is 1 / eta, so that a perfect mirror
/// (eta = infinity) is nothing special. Cook & Torrance's formula, times inverse throughout.
template <class T>
HWY_INLINE T fresnel(double inverse, T cosine) {
    // Below 1e-150 its square underflows; F has long been 1 (or 0 for eta = 1).
    const T c = max(cosine, T(1e-150));
    const T ec = inverse * c;
    const T g = sqrt((1 - inverse) * (1 + inverse) + ec * ec);
    const T sum = g + ec, difference = g - ec;
    const T a = difference / sum;
    const T b = (c * sum - inverse) / (c * difference + inverse);
    return 0.5 * a * a * (1.0 + b * b);
}

template <class T>
class CookTorranceTerms {
public:
    static constexpr std::size_t count = someTerms;

    HWY_INLINE CookTorranceTerms(const CookTorranceShape& shape, const Direction& wo)
        : shape_(shape), wo_(wo), inverse_(-1 / (shape.m * shape.m)) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const HalfVector<T> h(wo_, wi);
        const T squaredSlope = h.squaredSlope(), rise = 1.0 + squaredSlope;
        const T density = shape_.peak * exp(squaredSlope * inverse_) * rise * rise;
        const T cosine = h.dotOutgoing();
        const T lobe = bounded(density * bounded(vGrooveVisibility(h, wi.z, T(wo_.z))));
        for (const CookTorranceShape::Surface& surface : shape_.surfaces)
            *term++ = lobe * reflectance(surface, cosine);
    }

private:
    HWY_INLINE T reflectance(const CookTorranceShape::Surface& surface, T cosine) const {
        if (shape_.schlick) return schlickReflectanceOf(cosine, surface.f0);
        if (surface.ior > 0) return reflectanceOf(cosine, surface.ior, surface.k);
        return fresnel(surface.inverse, cosine);
    }

    const CookTorranceShape& shape_;
    Direction wo_;
    double inverse_;
};

void evalCookTorrance(const CookTorranceShape& shape, const TermBatch& batch) {
    evalLanes<CookTorranceTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
