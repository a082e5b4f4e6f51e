// Terms of ashikhmin_shirley.h. Included by ashikhmin_shirley.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/term_columns.h>

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
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = 3;

    HWY_INLINE AshikhminShirleyTerms(const AshikhminShirleyShape<N>& shape, const OutgoingOf<T>& wo)
        : nu_(shape.nu),
          nv_(shape.nv),
          ior_(shape.ior),
          wo_(wo),
          peak_(sqrt((shape.nu + 1) * (shape.nv + 1)) / (8 * pi)),
          outgoingFalloff_(diffuseFalloff(R(wo.z))) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const HalfVector<R> h(wo_, wi);
        const R inverse = 1.0 / (h.z * h.z);
        const R tx2 = h.x * h.x * inverse, ty2 = h.y * h.y * inverse, squaredSlope = tx2 + ty2;
        // log((h.z)^-2) per squared slope: log1p(t^2) / t^2.
        const R perSlope =
            select(squaredSlope > R(0.0), log1p(squaredSlope) / squaredSlope, R(1.0));
        const T power = exp(-0.5 * (nu_ * tx2 + nv_ * ty2) * perSlope);
        const R cosine = h.dotOutgoing();
        const R heights = max(cosine * max(wi.z, R(wo_.z)), R(5e-324));
        const T lobe = bounded(peak_ * power / heights);
        if (ior_ == 0) {
            const R weight = schlickWeightOf(cosine);
            term[0] = lobe * (1.0 - weight);
            term[1] = lobe * weight;
        } else {
            term[0] = lobe * reflectanceOf<T>(cosine, ior_, N(0.0));
            term[1] = T(0.0);
        }
        term[2] = diffuseFalloff(wi.z) * outgoingFalloff_;
    }

private:
    T nu_, nv_;
    N ior_;
    OutgoingOf<T> wo_;
    T peak_;
    R outgoingFalloff_;
};

struct AshikhminShirleyFormula {
    template <class T>
    using Terms = AshikhminShirleyTerms<T>;

    template <class N>
    static AshikhminShirleyShape<N> shape(const Values<N>& p) {
        return {p("nu"), p("nv"), p("ior")};
    }
    /// Weights of lobe times F0, lobe times Schlick's weight and diffuse; with `ior`, of lobe
    /// times F, 0 and diffuse.
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const N ior = p("ior"), ks = p("ks");
        const bool schlick = ior == 0;
        const N f0 = schlick ? p("Rs") : normalReflectanceOf(ior, N(0.0));
        const N diffuse = 28 * p("Rd") / (23 * pi) * (1 - f0);
        return {p("kd") / pi, {schlick ? ks * f0 : ks, ks, diffuse}};
    }
};

void evalAshikhminShirley(const AshikhminShirleyShape<double>& shape, const TermBatch& batch) {
    evalLanes<AshikhminShirleyTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> ashikhminShirleyColumns(const ColumnRequest& request) {
    return columnsOf<AshikhminShirleyFormula, 1>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
