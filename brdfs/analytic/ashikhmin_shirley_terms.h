// Terms of ashikhmin_shirley.h. Included by ashikhmin_shirley.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// 1 - (1 - c/2)^5.
template <class T>
HWY_INLINE T diffuseFalloff(T cosine) {
    const T e = 0.5 * cosine;
    return e * (5.0 - e * (10.0 - e * (10.0 - e * (5.0 - e))));
}

template <class T>
class AshikhminShirleyTerms {
public:
    static constexpr std::size_t count = 3;

    HWY_INLINE AshikhminShirleyTerms(const AshikhminShirleyShape& shape, const Direction& wo)
        : shape_(shape),
          wo_(wo),
          peak_(std::sqrt((shape.nu + 1) * (shape.nv + 1)) / (8 * pi)),
          outgoingFalloff_(diffuseFalloff(T(wo.z))) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const HalfVector<T> h(wo_, wi);
        const T inverse = 1.0 / (h.z * h.z);
        const T tx2 = h.x * h.x * inverse, ty2 = h.y * h.y * inverse, squaredSlope = tx2 + ty2;
        // log((h.z)^-2) per squared slope: log1p(t^2) / t^2.
        const T perSlope =
            select(squaredSlope > T(0.0), log1p(squaredSlope) / squaredSlope, T(1.0));
        const T power = exp(-0.5 * (shape_.nu * tx2 + shape_.nv * ty2) * perSlope);
        const T cosine = h.dotOutgoing();
        const T heights = max(cosine * max(wi.z, T(wo_.z)), T(5e-324));
        const T lobe = bounded(peak_ * power / heights);
        if (shape_.ior == 0) {
            const T weight = schlickWeightOf(cosine);
            term[0] = lobe * (1.0 - weight);
            term[1] = lobe * weight;
        } else {
            term[0] = lobe * reflectanceOf(cosine, shape_.ior, 0);
            term[1] = T(0.0);
        }
        term[2] = diffuseFalloff(wi.z) * outgoingFalloff_;
    }

private:
    AshikhminShirleyShape shape_;
    Direction wo_;
    double peak_;
    T outgoingFalloff_;
};

void evalAshikhminShirley(const AshikhminShirleyShape& shape, const TermBatch& batch) {
    evalLanes<AshikhminShirleyTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
