// Terms of sgd.h. Included by sgd.cpp once for each instruction set.

#include <brdfs/analytic/fresnel_terms.h>
#include <brdfs/analytic/half_vector.h>
#include <brdfs/lanes/lanes_angles.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// D / pi
template <class T>
HWY_INLINE T density(const ShiftedGamma& lobe, T squaredSlope) {
    const T u = lobe.alpha + squaredSlope / lobe.alpha, rise = 1.0 + squaredSlope;
    return bounded(lobe.peak * exp(-u - lobe.p * log(u)) * rise * rise);
}

/// G1 / cos(theta) of a direction of height z and angle theta.
template <class T>
HWY_INLINE T visibility(const ShiftedGamma& lobe, T z, T theta) {
    const T beyond = max(T(0.0), theta - T(lobe.theta0));
    const T fall = expm1(min(T(700.0), bounded(lobe.c * pow(beyond, T(lobe.k)))));
    return min(max(1.0 - lobe.lambda * fall, T(0.0)), T(1.0)) / z;
}

template <class T>
HWY_INLINE T polarAngleOf(const Incoming<T>& w) {
    return PolarAngle<T>(sqrt(w.x * w.x + w.y * w.y), w.z).theta;
}

template <class T>
class SgdTerms {
public:
    static constexpr std::size_t count = someTerms;

    HWY_INLINE SgdTerms(const SgdShape& shape, const Direction& wo) : shape_(shape), wo_(wo) {
        const Incoming<T> outgoing{T(wo.x), T(wo.y), T(wo.z)};
        const T theta = polarAngleOf(outgoing);
        for (std::size_t c = 0; c < shape.lobes.size(); ++c)
            outgoing_[c] = visibility(shape.lobes[c], outgoing.z, theta);
    }

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const HalfVector<T> h(wo_, wi);
        const T squaredSlope = h.squaredSlope(), cosine = h.dotOutgoing();
        const T theta = polarAngleOf(wi);
        for (std::size_t c = 0; c < shape_.lobes.size(); ++c) {
            const ShiftedGamma& lobe = shape_.lobes[c];
            const T visible = bounded(visibility(lobe, wi.z, theta) * outgoing_[c]);
            const T fresnel = max(T(0.0), schlickReflectanceOf(cosine, lobe.f0) - lobe.f1 * cosine);
            term[c] = fresnel * bounded(density(lobe, squaredSlope) * visible);
        }
    }

private:
    const SgdShape& shape_;
    Direction wo_;
    T outgoing_[TermBatch::maxTerms];
};

void evalSgd(const SgdShape& shape, const TermBatch& batch) {
    evalLanes<SgdTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
