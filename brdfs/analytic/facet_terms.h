// Terms of the microfacet models (microfacet.h). Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_FACET_TERMS_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_FACET_TERMS_H
#undef BRDFS_ANALYTIC_FACET_TERMS_H
#else
#define BRDFS_ANALYTIC_FACET_TERMS_H
#endif

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/analytic/microfacet.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// term[t] = lobe F_t(cosine). `lobe` is finite; so is the result.
template <class T, class R, class N>
HWY_INLINE void spread(const std::vector<FacetIndex<N>>& indices, const T& lobe, R cosine,
                       T* term) {
    if (indices.empty()) {
        const R weight = schlickWeightOf(cosine);
        term[0] = lobe * (1.0 - weight);
        term[1] = lobe * weight;
        return;
    }
    for (const FacetIndex<N>& index : indices)
        *term++ = lobe * reflectanceOf<T>(cosine, index.ior, index.k);
}

/// `Distribution<T>(shape)` gives D of a half vector, and z Lambda(w) of a direction w with height
/// z, finite at the horizon, where Lambda is not.
template <class T, template <class> class Distribution, template <class> class Shape>
class FacetTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = someTerms;

    HWY_INLINE FacetTerms(const FacetShape<Shape<N>, N>& shape, const OutgoingOf<T>& wo)
        : distribution_(shape.distribution),
          indices_(shape.indices),
          wo_(wo),
          outgoing_(distribution_.scaledLambda({R(wo.x), R(wo.y), R(wo.z)})),
          correlated_(shape.correlated) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const Incoming<R> above{wi.x, wi.y, max(wi.z, R(0.0))};
        const HalfVector<R> h(wo_, above);
        const T incoming = distribution_.scaledLambda(above);
        const T visible = correlated_ ? above.z * wo_.z + wo_.z * incoming + above.z * outgoing_
                                      : (above.z + incoming) * (wo_.z + outgoing_);
        const T lobe = bounded(distribution_.density(h) * bounded(0.25 / visible));
        spread(indices_, lobe, h.dotOutgoing(), term);
    }

private:
    Distribution<T> distribution_;
    const std::vector<FacetIndex<N>>& indices_;
    OutgoingOf<T> wo_;
    T outgoing_;
    bool correlated_;
};

/// The formula of a microfacet model for fits; `Distribution::shape` gives the parameters of D.
template <class N>
Weights<N> facetWeights(const Values<N>& p) {
    const N constant = p("kd") / pi, ks = p("ks");
    if (!p.chosen("fresnel", "schlick")) return {constant, {ks}};
    return {constant, {p("F0") * ks, ks}};
}
template <class Shape, class N>
FacetShape<Shape, N> facetShape(const Values<N>& p, const Shape& distribution) {
    FacetShape<Shape, N> shape{distribution, {}, p.chosen("masking", "correlated")};
    if (!p.chosen("fresnel", "schlick"))
        shape.indices.push_back({p("ior"), p.chosen("fresnel", "conductor") ? p("k") : N(0.0)});
    return shape;
}
/// alpha, or ax and ay.
template <class N>
RoughnessOf<N> facetRoughness(const Values<N>& p) {
    const N alpha = p("alpha");
    if (alpha > N(0.0)) return {alpha, alpha};
    return {p("ax"), p("ay")};
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
