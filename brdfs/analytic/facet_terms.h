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

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// term[t] = lobe F_t(cosine). `lobe` is finite; so is the result.
template <class T>
HWY_INLINE void spread(const FacetFresnel& fresnel, T lobe, T cosine, T* term) {
    if (fresnel.indices().empty()) {
        const T weight = schlickWeightOf(cosine);
        term[0] = lobe * (1.0 - weight);
        term[1] = lobe * weight;
        return;
    }
    for (const FacetFresnel::Index& index : fresnel.indices())
        *term++ = lobe * reflectanceOf(cosine, index.ior, index.k);
}

/// `Distribution<T>(shape)` gives D of a half vector, and z Lambda(w) of a direction w with height
/// z, finite at the horizon, where Lambda is not.
template <class T, template <class> class Distribution, class Shape>
class FacetTerms {
public:
    static constexpr std::size_t count = someTerms;

    HWY_INLINE FacetTerms(const FacetShape<Shape>& shape, const Direction& wo)
        : distribution_(shape.distribution),
          fresnel_(shape.fresnel),
          wo_(wo),
          outgoing_(distribution_.scaledLambda({T(wo.x), T(wo.y), T(wo.z)})),
          correlated_(shape.correlated) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const Incoming<T> above{wi.x, wi.y, max(wi.z, T(0.0))};
        const HalfVector<T> h(wo_, above);
        const T incoming = distribution_.scaledLambda(above);
        const T visible = correlated_ ? above.z * wo_.z + wo_.z * incoming + above.z * outgoing_
                                      : (above.z + incoming) * (wo_.z + outgoing_);
        const T lobe = bounded(distribution_.density(h) * bounded(0.25 / visible));
        spread(fresnel_, lobe, h.dotOutgoing(), term);
    }

private:
    Distribution<T> distribution_;
    const FacetFresnel& fresnel_;
    Direction wo_;
    T outgoing_;
    bool correlated_;
};

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
