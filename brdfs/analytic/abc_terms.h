// Terms of abc.h. Included by abc.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class AbcTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE AbcTerms(const AbcShape& shape, const Direction& wo) : shape_(shape), wo_(wo) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const HalfVector<T> h(wo_, wi);
        const T reflectance = reflectanceOf(h.dotOutgoing(), shape_.ior, 0);
        if (shape_.smooth) {
            const T squared = h.scale * h.scale * (h.x * h.x + h.y * h.y);
            term[0] = reflectance * tail(squared);
        } else {
            const T visible = vGrooveVisibility(h, wi.z, T(wo_.z));
            const T slopes = tail(slopeVersine(h.squaredSlope()));
            term[0] = reflectance * bounded(slopes * visible * (1 / pi));
        }
    }

private:
    /// (1 + B x)^-C
    HWY_INLINE T tail(T x) const { return exp(-shape_.c * log1p(shape_.b * x)); }

    AbcShape shape_;
    Direction wo_;
};

void evalAbc(const AbcShape& shape, const TermBatch& batch) {
    evalLanes<AbcTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
