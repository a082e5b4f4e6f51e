// Terms of openpbr.h. Included by openpbr.cpp once for each instruction set.

#include <brdfs/analytic/eon_lobe.h>
#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/ggx_facets.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class OpenpbrTerms {
public:
    static constexpr std::size_t count = 8;

    HWY_INLINE OpenpbrTerms(const OpenpbrShape& shape, const Direction& wo)
        : shape_(shape),
          wo_(wo),
          base_(shape.base),
          coat_(shape.coat),
          diffuse_(shape.diffuse, wo),
          layers_(shape.layersAt(wo)) {
        const Incoming<T> outgoing{T(wo.x), T(wo.y), T(wo.z)};
        outgoing_ = base_.scaledLambda(outgoing);
        coatOutgoing_ = coat_.scaledLambda(outgoing);
    }

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const Incoming<T> above{wi.x, wi.y, max(wi.z, T(0.0))};
        const HalfVector<T> h(wo_, above);
        const T cosine = h.dotOutgoing(), rest = 1.0 - cosine, rise = schlickWeightOf(cosine);
        const T lobe = layers_.under * base_.lobe(h, above, T(wo_.z), outgoing_);
        diffuse_(wi, term);
        for (int i = 0; i < 2; ++i) term[i] = layers_.diffuse * bounded(term[i]);
        term[2] = lobe * reflectanceOf<T>(cosine, shape_.eta, 0.0);
        term[3] = lobe * (1.0 - rise);
        term[4] = lobe * rise;
        term[5] = lobe * (cosine * rise * rest);
        term[6] = T(0.0);
        if (shape_.coatWeight > 0)
            term[6] = layers_.coat * coat_.lobe(h, above, T(wo_.z), coatOutgoing_) *
                      reflectanceOf<T>(cosine, shape_.coatEta, 0.0);
        term[7] = T(0.0);
        if (shape_.fuzzWeight > 0) term[7] = fuzz(above);
    }

private:
    /// E_z / pi (a / |M wi|^2)^2, M = (a 0 b; 0 a 0; 0 0 1) in the plane of wo and the normal.
    HWY_INLINE T fuzz(const Incoming<T>& wi) const {
        const OpenpbrFuzz& own = layers_.fuzz;
        const T along = wi.x * own.x + wi.y * own.y, across = wi.y * own.x - wi.x * own.y;
        const T x = own.a * along + own.b * wi.z, y = own.a * across;
        const T ratio = own.a / (x * x + y * y + wi.z * wi.z);
        return own.albedo / pi * (ratio * ratio);
    }

    const OpenpbrShape& shape_;
    Direction wo_;
    GgxFacets<T> base_, coat_;
    EonTerms<T> diffuse_;
    OpenpbrLayers layers_;
    T outgoing_, coatOutgoing_;
};

void evalOpenpbr(const OpenpbrShape& shape, const TermBatch& batch) {
    evalLanes<OpenpbrTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
